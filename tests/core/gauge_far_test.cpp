// The gauge of worlds far from the origin, as in UTM coordinates.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/optimizer.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::ElementsAre;

/// The heading of a pose, measured outright.
class EdgeCompass : public BaseEdge<EdgeCompass, 1, double, VertexSE2> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& z, const SE2<S>& x) {
    return Vector<S, 1>(wrapAngle(S(x.rotation().log()[0] - z)));
  }
};

std::vector<int> freedoms(Graph& graph) {
  const Problem problem(graph, {});
  std::vector<int> result;
  for (const ComponentGauge& gauge : findGauges(problem)) result.push_back(gauge.free);
  return result;
}

/// A ring of ten poses about (east, north); with a compass of some information at pose 3.
Graph ringAt(double east, double north, double compass) {
  const Graph near = ringGraph<EdgeRangeDual>(10, 0);
  auto registry = makeRegistry();
  registry->addEdge<EdgeCompass>("EDGE_COMPASS");
  Graph graph(registry);
  const SE2<double> shift(east, north, 0.0);
  for (int id = 0; id < 10; ++id) graph.addVertex<VertexSE2>(id, shift * near.vertex<VertexSE2>(id).estimate());
  near.forEachEdge([&](const Edge& edge) {
    const auto& odometry = static_cast<const EdgeSE2&>(edge);
    graph.addEdge<EdgeSE2>({odometry.vertexId(0), odometry.vertexId(1)}, odometry.measurement(),
                           odometry.information());
  });
  if (compass > 0.0) graph.addEdge<EdgeCompass>({3}, 0.4, weight(compass));
  return graph;
}

TEST(GaugeFar, AWeakCompassIsNoticedAnywhere) {
  for (const double distance : {0.0, 1e3, 1e6, 5e6, 1e8}) {
    Graph without = ringAt(distance, -0.7 * distance, 0.0);
    EXPECT_THAT(freedoms(without), ElementsAre(3)) << distance;
    Graph with = ringAt(distance, -0.7 * distance, 1e-3);
    EXPECT_THAT(freedoms(with), ElementsAre(2)) << distance;
  }
}

TEST(GaugeFar, AHeadingIsFoundAnywhere) {
  for (const double distance : {0.0, 5e6}) {
    Graph graph = ringAt(distance, distance, 1e-3);
    const Summary summary = optimize(graph, {.algorithm = "gn"});
    EXPECT_EQ(summary.status, Status::converged) << summary.reason;
    // The coordinates are rounded to 1e-9 m there: with the odometry's weight, what that pulls against the compass.
    const double rounding = distance > 0.0 ? 2500.0 * 1e-9 / 1e-3 : 1e-6;
    EXPECT_NEAR(graph.vertex<VertexSE2>(3).estimate().rotation().log()[0], 0.4, rounding) << distance;
  }
}

/// Three poses so many units apart, as precise as that is long, which do not quite agree.
Graph triangle(double side) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>(0.0, 0.0, 0.0));
  graph.addVertex<VertexSE2>(1, SE2<double>(1.1 * side, 0.1 * side, 2.2));
  graph.addVertex<VertexSE2>(2, SE2<double>(0.4 * side, 0.9 * side, -2.0));
  const SE2<double> along(side, 0.02 * side, 2.1);
  const double place = 100.0 / side / side;
  const Matrix<double, 3, 3> information = Vector<double, 3>(place, place, 100.0).asDiagonal();
  for (int i = 0; i < 3; ++i) graph.addEdge<EdgeSE2>({i, (i + 1) % 3}, along, information);
  return graph;
}

TEST(GaugeFar, AWorldOfAnyWidthIsHeldByItsFirstPose) {
  Graph unit = triangle(1.0);
  const Summary expected = optimize(unit, {.algorithm = "gn"});
  EXPECT_EQ(expected.status, Status::converged);
  for (const double side : {1e-6, 1e-3, 1e3, 1e6, 3e6, 1e7, 1e9, 1e12}) {
    Graph graph = triangle(side);
    const Summary summary = optimize(graph, {.algorithm = "gn"});
    EXPECT_EQ(summary.status, Status::converged) << side;
    EXPECT_EQ(summary.gauge.fixed, expected.gauge.fixed) << side;
    EXPECT_NEAR(summary.finalChi2, expected.finalChi2, 1e-6 * expected.finalChi2) << side;
    EXPECT_EQ(graph.vertex<VertexSE2>(0).estimate().toVector(), (Vector<double, 3>(0.0, 0.0, 0.0))) << side;
  }
}

TEST(GaugeFar, ManyHeldVerticesAreCounted) {
  Graph graph(makeRegistry());
  for (int i = 0; i < 20; ++i) {
    graph.addVertex<VertexSE2>(2 * i, SE2<double>(0.0, 0.0, 0.0));
    graph.addVertex<VertexSE2>(2 * i + 1, SE2<double>(1.0, 0.0, 0.0));
    graph.addEdge<EdgeSE2>({2 * i, 2 * i + 1}, SE2<double>(1.1, 0.0, 0.1), Matrix<double, 3, 3>::Identity());
  }
  const Summary summary = optimize(graph, {.algorithm = "gn"});
  EXPECT_EQ(summary.gauge.fixed.size(), 20U);
  EXPECT_THAT(summary.gauge.reason, ::testing::HasSubstr("vertex 0, 2, 4, 6, 8, 10, 12, 14 and 12 others held"));
}

TEST(GaugeFar, ASinglePointFarAwayIsFreeInTwoDirections) {
  for (const double distance : {0.0, 1.0, 1e7}) {
    Graph graph(makeRegistry());
    graph.addVertex<VertexSE2>(0, SE2<double>(distance, 1.0, 0.3));
    graph.addVertex<VertexPoint>(1000, Vector<double, 2>(distance, 5.0));
    graph.addEdge<EdgeRangeDual>({0, 1000}, 4.0, weight(1.0));
    graph.vertex<VertexSE2>(0).setFixed(true);
    // The range holds the distance from the pose; one direction is left.
    EXPECT_THAT(freedoms(graph), ElementsAre(1)) << distance;
    graph.vertex<VertexSE2>(0).setFixed(false);
    EXPECT_THAT(freedoms(graph), ElementsAre(3)) << distance;
  }
}

}  // namespace
}  // namespace quiver
