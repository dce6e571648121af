// Types that the library does not bring: groups as estimates, robust kernels.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/registry/conformance.h>
#include <quiver/plugins/builtin.h>

namespace quiver {
namespace {

using ::testing::HasSubstr;

template <typename Group, int dimension>
class VertexOf : public BaseVertex<VertexOf<Group, dimension>, dimension, Group> {
 public:
  template <typename G, typename S>
  static G oplus(const G& x, const Vector<S, dimension>& delta) {
    return x * G::exp(delta);
  }
};
class VertexTurn : public BaseVertex<VertexTurn, 1, SO2<double>> {
 public:
  static SO2<double> oplus(const SO2<double>& x, const Vector<double, 1>& delta) { return x * SO2<double>(delta[0]); }
};
using VertexRotation = VertexOf<SO3<double>, 3>;
using VertexSimilarity = VertexOf<Sim3<double>, 7>;

template <typename Group, int dimension>
class EdgeOf : public BaseEdge<EdgeOf<Group, dimension>, dimension, Group, VertexOf<Group, dimension>> {
 public:
  static auto computeError(const Group& z, const Group& x) { return Vector<double, dimension>(z.between(x).log()); }
};

std::string findingOf(const RobustKernelType& kernel) {
  auto registry = std::make_shared<Registry>();
  registry->addRobustKernel(kernel);
  const ConformanceReport report = checkConformance(registry);
  return report.findings.empty() ? "" : report.findings[0].message;
}

TEST(FurtherTypes, GroupsServeAsEstimatesAndMeasurements) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexTurn>("TURN");
  registry->addVertex<VertexRotation>("ROTATION");
  registry->addVertex<VertexSimilarity>("SIMILARITY");
  registry->addEdge<EdgeOf<SO3<double>, 3>>("EDGE_ROTATION");
  registry->addEdge<EdgeOf<Sim3<double>, 7>>("EDGE_SIMILARITY");
  const ConformanceReport report = checkConformance(registry);
  EXPECT_TRUE(report.passed()) << report.describe();
  EXPECT_EQ(report.types, 5);
}

TEST(FurtherTypes, BuiltinKernelsConform) {
  const auto registry = builtinRegistry();
  ConformanceReport report;
  for (const RobustKernelType* kernel : registry->robustKernels()) {
    checkKernels(*registry, {std::string(kernel->name)}, report);
  }
  EXPECT_TRUE(report.passed()) << report.describe();
  EXPECT_GE(report.checks, 10);
  EXPECT_THROW(checkKernels(*registry, {"none such"}, report), GraphError);
}

/// Formulas whose terms are as large as w² round as w² does, however small the error is.
TEST(FurtherTypes, KernelsAsTextbooksWriteThemConform) {
  EXPECT_EQ(
      findingOf({"SquareRoot",
                 [](double e, double w, double) {
                   const double root = std::sqrt(1.0 + e / (w * w));
                   return RobustValue{2.0 * w * w * (root - 1.0), 1.0 / root, -0.5 / (w * w * root * root * root)};
                 },
                 ""}),
      "");
  EXPECT_EQ(findingOf({"Logarithm",
                       [](double e, double w, double) {
                         const double sum = 1.0 + e / (w * w);
                         return RobustValue{w * w * std::log(sum), 1.0 / sum, -1.0 / (w * w * sum * sum)};
                       },
                       ""}),
            "");
  EXPECT_EQ(findingOf({"Exponential",
                       [](double e, double w, double) {
                         const double weight = std::exp(-e / (w * w));
                         return RobustValue{w * w * (1.0 - weight), weight, -weight / (w * w)};
                       },
                       ""}),
            "");
}

class VertexThreeNames : public BaseVertex<VertexThreeNames, 2, Vector<double, 2>> {
 public:
  static constexpr const char* tangent[] = {"x", "y", "z"};
  static Vector<double, 2> oplus(const Vector<double, 2>& x, const Vector<double, 2>& delta) { return x + delta; }
};

TEST(FurtherTypes, NamesOfDirectionsAreCounted) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexThreeNames>("THREE");
  EXPECT_THAT(checkConformance(registry).describe(), HasSubstr("3 names for 2 directions"));
}

TEST(FurtherTypes, KernelsThatBreakPromisesAreFound) {
  EXPECT_THAT(findingOf({"A",
                         [](double e, double, double) {
                           return RobustValue{e + 1.0, 1.0, 0.0};
                         },
                         ""}),
              HasSubstr("at 0, width 0.1, rho is 1"));
  EXPECT_THAT(findingOf({"B",
                         [](double e, double, double) {
                           return RobustValue{e, 2.0 - std::exp(-e), 0.0};
                         },
                         ""}),
              HasSubstr("the slope of rho 1"));
  EXPECT_THAT(findingOf({"C",
                         [](double e, double, double) {
                           return RobustValue{1.0 - std::exp(-e), std::exp(-e), std::exp(-e)};
                         },
                         ""}),
              HasSubstr("the slope of the weight -"));
  EXPECT_THAT(findingOf({"D",
                         [](double e, double, double) {
                           return RobustValue{e, e > 9.0 ? NAN : 1.0, 0.0};
                         },
                         ""}),
              HasSubstr("they must be finite"));
  EXPECT_THAT(findingOf({"E",
                         [](double e, double, double) {
                           return RobustValue{e, 1.0, 0.0};
                         },
                         "", false, 0.0, false,
                         [](std::span<const double> e, double, double, const RobustValues& out) {
                           for (std::size_t i = 0; i < e.size(); ++i) out.rho[i] = out.weight[i] = 1.0;
                         }}),
              HasSubstr("many at once differ from one"));
}

}  // namespace
}  // namespace quiver
