#include <gtest/gtest.h>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/registry/conformance.h>

namespace quiver {
namespace {

using Point = Vector<double, 2>;

class GoodPoint : public BaseVertex<GoodPoint, 2, Point> {
 public:
  static Point oplus(const Point& x, const Point& delta) { return x + delta; }
};

/// Moves along one direction only, and not by zero.
class LamePoint : public BaseVertex<LamePoint, 2, Point> {
 public:
  static Point oplus(const Point& x, const Point& delta) {
    return x + Point(delta[0] + delta[1] + 1e-3, delta[0] + delta[1]);
  }
};

/// Writes six digits.
class BluntPoint : public BaseVertex<BluntPoint, 2, Point> {
 public:
  static Point oplus(const Point& x, const Point& delta) { return x + delta; }
  static std::vector<Field> fields() { return {{"x", "m", ""}}; }
  void read(FieldReader& reader) {
    const double x = reader.real();
    setEstimate(Point(x, reader.real()));
  }
  void write(FieldWriter& writer) const {
    for (int i = 0; i < 2; ++i) writer.real(static_cast<double>(static_cast<float>(values()[i])));
  }
};

/// Has a wrong sign in its Jacobian.
class WrongEdge : public BaseEdge<WrongEdge, 2, Point, GoodPoint> {
 public:
  static Point computeError(const Point& z, const Point& x) { return x - z; }
  static void linearizeOplus(const Point&, const Point&, Matrix<double, 2, 2>& J) {
    J.setIdentity();
    J(1, 1) = -1.0;
  }
};

std::string findings(const std::shared_ptr<Registry>& registry, const std::string& tag) {
  std::string checks;
  for (const ConformanceFinding& finding : checkConformance(registry).findings) {
    if (finding.tag == tag) checks += finding.check + ";";
  }
  return checks;
}

TEST(Conformance, NamesBrokenPromises) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<GoodPoint>("GOOD_POINT");
  registry->addVertex<LamePoint>("LAME_POINT");
  registry->addEdge<WrongEdge>("WRONG_EDGE");
  EXPECT_EQ(findings(registry, "GOOD_POINT"), "");
  EXPECT_EQ(findings(registry, "LAME_POINT"), "oplus;");
  EXPECT_EQ(findings(registry, "WRONG_EDGE"), "jacobians;");
  registry->addVertex<BluntPoint>("BLUNT_POINT");
  EXPECT_EQ(findings(registry, "BLUNT_POINT"), "fields;round trip;");
}

/// Its first error jumps by 2 where x passes z.
class JumpingEdge : public BaseEdge<JumpingEdge, 2, Point, GoodPoint> {
 public:
  static Point computeError(const Point& z, const Point& x) { return Point(x[0] > z[0] ? 1.0 : -1.0, 2.0 * x[1]); }
  static void linearizeOplus(const Point&, const Point&, Matrix<double, 2, 2>& J) { J << 0.0, 0.0, 0.0, 2.0; }
};

TEST(JacobianCheck, LeavesOutWhereTheErrorJumps) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<GoodPoint>("GOOD_POINT");
  registry->addEdge<JumpingEdge>("JUMPING_EDGE");
  Graph graph(registry);
  graph.addVertex<GoodPoint>(0, Point(0.0, 0.0));
  graph.addEdge<JumpingEdge>({0}, Point(0.0, 0.0), Matrix<double, 2, 2>::Identity());
  const JacobianReport report = checkJacobians(graph);
  ASSERT_EQ(report.types.size(), 1u);
  EXPECT_EQ(report.types[0].jumps, 1);
  EXPECT_LT(report.worstDeviation(), 1e-9) << report.describe();
}

TEST(JacobianCheck, StepsAroundAJump) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<GoodPoint>("GOOD_POINT");
  registry->addEdge<JumpingEdge>("JUMPING_EDGE");
  Graph graph(registry);
  graph.addVertex<GoodPoint>(0, Point(0.0, 0.0));
  graph.addEdge<JumpingEdge>({0}, Point(1e-6, 0.0), Matrix<double, 2, 2>::Identity());
  const JacobianReport report = checkJacobians(graph);
  EXPECT_EQ(report.types[0].jumps, 0);
  EXPECT_LT(report.worstDeviation(), 1e-9) << report.describe();
}

TEST(Conformance, ReportsWhatItSaw) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<GoodPoint>("GOOD_POINT");
  registry->addEdge<WrongEdge>("WRONG_EDGE");
  const std::string text = checkConformance(registry).describe();
  EXPECT_NE(text.find("WRONG_EDGE: jacobians: analytic"), std::string::npos) << text;
  EXPECT_NE(text.find("-1 instead of 1"), std::string::npos) << text;
  ConformanceOptions only;
  only.tags = {"GOOD_POINT"};
  EXPECT_TRUE(checkConformance(registry, only).passed());
}

}  // namespace
}  // namespace quiver
