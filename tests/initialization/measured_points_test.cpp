// The initial guess that takes pixels with depths for the points they measure.
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/quiver.h>
#include <quiver/types_slam3d/edge_se3.h>
#include <quiver/types_slam3d/edge_se3_projection.h>
#include <quiver/types_slam3d/measured_points.h>

namespace quiver {
namespace {

using ::testing::HasSubstr;
using Vector3 = Vector<double, 3>;

constexpr int poses = 160;
constexpr int points = 120;

/// A camera that looks along the body's x axis.
Vector<double, 11> camera() {
  Vector<double, 11> numbers;
  numbers << 0.0, 0.0, 0.3, -0.5, 0.5, -0.5, 0.5, 500.0, 500.0, 320.0, 240.0;
  return numbers;
}

/// Two rounds on a circle of ten metres, at the truth. Odometry turns too far by a hundredth of a radian a step, so
/// that dead reckoning ends metres away; points are seen with a little noise.
template <typename E>
Graph circle() {
  Graph graph(builtinRegistry());
  graph.addParameter<ParameterCamera>(1, camera());
  std::mt19937_64 random(11);
  const auto noise = [&](double deviation) {
    return deviation * (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0);
  };
  std::vector<SE3<double>> truth;
  for (int i = 0; i < poses; ++i) {
    const double angle = 4.0 * M_PI * i / poses;
    truth.emplace_back(10.0 * std::cos(angle), 10.0 * std::sin(angle), 0.0, 0.0, 0.0,
                       std::sin(0.5 * angle + 0.25 * M_PI), std::cos(0.5 * angle + 0.25 * M_PI));
    graph.addVertex<VertexSE3>(i, truth.back());
  }
  graph.vertex<VertexSE3>(0).setFixed(true);
  Matrix<double, 6, 6> odometry = 1e4 * Matrix<double, 6, 6>::Identity();
  odometry.topLeftCorner<3, 3>() *= 1e-2;
  for (int i = 0; i + 1 < poses; ++i) {
    Vector<double, 6> drift;
    drift << noise(0.05), noise(0.05), noise(0.05), noise(0.003), noise(0.003), 0.01;
    graph.addEdge<EdgeSE3>({i, i + 1}, truth[i].between(truth[i + 1]).retract(drift), odometry);
  }
  const SE3<double> inBody = detail::cameraPose(camera());
  const Matrix<double, 3, 3> information = Vector3(1.0, 1.0, 100.0).asDiagonal();
  for (int p = 0; p < points; ++p) {
    const double angle = 2.0 * M_PI * p / points;
    const double radius = 10.0 + 2.0 * std::sin(7.0 * p);
    const Vector3 place(radius * std::cos(angle), radius * std::sin(angle), std::cos(3.0 * p));
    bool seen = false;
    for (int i = 0; i < poses; ++i) {
      const Vector3 at = (truth[i] * inBody).actInverse(place);
      if (at[2] < 0.5 || at.norm() > 5.0 || std::hypot(at[0], at[1]) > at[2]) continue;
      if (!seen) graph.addVertex<VertexXYZ>(1000 + p, place);
      seen = true;
      const double depth = at[2];
      const Vector3 z(500.0 * at[0] / depth + 320.0 + noise(1.0), 500.0 * at[1] / depth + 240.0 + noise(1.0),
                      std::is_same_v<E, EdgeSE3Disparity> ? 1.0 / depth + noise(0.01) : depth + noise(0.1));
      graph.addEdge<E>({i, 1000 + p}, z, information, {1});
    }
  }
  return graph;
}

/// Estimates by dead reckoning, and points from where they are seen first.
void reckon(Graph& graph) {
  std::as_const(graph).forEachVertex([&](const Vertex& vertex) {
    if (vertex.fixedDirections() == 0) const_cast<Vertex&>(vertex).setHasEstimate(false);
  });
  odometryEstimate(graph);
}

template <typename E>
void expectTheOptimum() {
  Graph atTruth = circle<E>();
  const Summary best = optimize(atTruth);
  ASSERT_EQ(best.status, Status::converged) << best.reason;
  Graph graph = circle<E>();
  reckon(graph);
  const AutomaticStart start = automaticStart(graph);
  EXPECT_EQ(start.name, "points") << start.reason;
  EXPECT_THAT(start.reason, HasSubstr("taken for points"));
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_NEAR(summary.finalChi2, best.finalChi2, 1e-6 * best.finalChi2);
  EXPECT_LE(summary.iterations.size(), 20U);
}

TEST(MeasuredPoints, LeadToTheOptimumWithDepths) { expectTheOptimum<EdgeSE3Depth>(); }
TEST(MeasuredPoints, LeadToTheOptimumWithDisparities) { expectTheOptimum<EdgeSE3Disparity>(); }

TEST(MeasuredPoints, NeedSuchEdges) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE3>(0, SE3<double>());
  EXPECT_THROW(measuredPointsEstimate(graph), GraphError);
}

}  // namespace
}  // namespace quiver
