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
