#include <quiver/core/algorithm/gauge.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam2d/edge_se2_prior.h>
#include <quiver/types_slam3d/edge_se3.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<int> freedoms(Graph& graph) {
  const Problem problem(graph, {});
  std::vector<int> result;
  for (const ComponentGauge& gauge : findGauges(problem)) result.push_back(gauge.free);
  return result;
}

/// A ring of poses, and n = 10 vertices.
Graph ring() { return ringGraph<EdgeRangeDual>(10, 0); }

/// Poses in space, each measured from the one before.
Graph chainInSpace() {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexSE3>("VERTEX_SE3:QUAT");
  registry->addEdge<EdgeSE3>("EDGE_SE3:QUAT");
  registerLinearSystems(*registry);
  Graph graph(registry);
  for (int id = 0; id < 6; ++id) {
    const Vector<double, 6> tangent = 0.3 * id * Vector<double, 6>::Ones();
    graph.addVertex<VertexSE3>(id, SE3<double>::exp(tangent));
  }
  const Matrix<double, 6, 6> information = Matrix<double, 6, 6>::Identity();
  for (int id = 0; id < 5; ++id) graph.addEdge<EdgeSE3>({id, id + 1}, SE3<double>(), information);
  return graph;
}

TEST(Gauge, CountsTheMotionsOfAWorld) {
  Graph planar = ring();
  EXPECT_THAT(freedoms(planar), ElementsAre(3));
  Graph spatial = chainInSpace();
  EXPECT_THAT(freedoms(spatial), ElementsAre(6));
}

TEST(Gauge, FixedVerticesAndDirectionsTakeFreedomAway) {
  Graph graph = ring();
  graph.vertex<VertexSE2>(4).setFixedDirections(0b100);
  EXPECT_THAT(freedoms(graph), ElementsAre(2));
  graph.vertex<VertexSE2>(4).setFixedDirections(0b111);
  EXPECT_THAT(freedoms(graph), ElementsAre(0));
}

TEST(Gauge, AFixedVertexSeparatesComponents) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 5; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(id, 0.3, 0.1));
  for (int id = 0; id < 4; ++id) graph.addEdge<EdgeSE2>({id, id + 1}, SE2<double>(1.0, 0.0, 0.0), weight3());
  EXPECT_THAT(freedoms(graph), ElementsAre(3));
  graph.vertex<VertexSE2>(2).setFixed(true);
  EXPECT_THAT(freedoms(graph), ElementsAre(0, 0));
}

TEST(Gauge, AnIslandHoldsOneVertexOfItsOwn) {
  Graph graph = ring();
  for (int id = 50; id < 52; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(id, 0.0, 0.0));
  graph.addEdge<EdgeSE2>({50, 51}, SE2<double>(1.0, 0.0, 0.0), weight3());
  EXPECT_THAT(freedoms(graph), ElementsAre(3, 3));
  const Summary fixed = optimize(graph, {.algorithm = "gn"});
  EXPECT_EQ(fixed.status, Status::converged) << fixed.reason;
  EXPECT_THAT(fixed.gauge.fixed, ElementsAre(0, 50));
  EXPECT_EQ(fixed.gauge.components, 2);
  const Summary damped = optimize(graph, {.algorithm = "lm"});
  EXPECT_TRUE(damped.gauge.fixed.empty());
  EXPECT_EQ(damped.gauge.free, 6);
  EXPECT_NEAR(damped.finalChi2, fixed.finalChi2, 1e-9 * fixed.finalChi2);
}

/// One vertex has fewer directions than there are generators; those that cancel on it are no freedom.
TEST(Gauge, ASingleVertexAmongFixedOnes) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>(3.0, 1.0, 0.4)).setFixedDirections(0b100);
  for (int id = 1; id < 4; ++id) {
    graph.addVertex<VertexPoint>(id, Vector<double, 2>(id * id, 4.0 * id)).setFixed(true);
    graph.addEdge<EdgeRangeDual>({0, id}, 2.0, weight(1.0));
  }
  EXPECT_THAT(freedoms(graph), ElementsAre(0));
  EXPECT_EQ(optimize(graph).variables, 1);
}

/// The pivots of a pose whose direction nobody measures are not numbers, once scaled.
TEST(Gauge, APoseWithPositionsAloneMayTurn) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>(0.3, -0.2, 0.5));
  for (int i = 0; i < 3; ++i) {
    graph.addEdge<EdgePriorSE2XY>({0}, Vector<double, 2>(1.0 + 0.1 * i, 2.0 - 0.1 * i),
                                  Matrix<double, 2, 2>::Identity());
  }
  EXPECT_THAT(freedoms(graph), ElementsAre(1));
  const Summary summary = optimize(graph, {.algorithm = "gn"});
  EXPECT_TRUE(summary.converged()) << summary.reason;
  EXPECT_NEAR(graph.vertex<VertexSE2>(0).estimate().x(), 1.1, 1e-9);
}

TEST(Gauge, FarFromTheOriginItIsTheSame) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 20; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(4e5 + id, 5e6, 0.1 * id));
  for (int id = 0; id < 19; ++id) graph.addEdge<EdgeSE2>({id, id + 1}, SE2<double>(1.0, 0.0, 0.1), weight3());
  EXPECT_THAT(freedoms(graph), ElementsAre(3));
}

TEST(Diagnosis, NamesAMissingGauge) {
  Graph graph = ring();
  const Summary summary = optimize(graph, {.algorithm = "gn", .gauge = GaugePolicy::free});
  EXPECT_EQ(summary.status, Status::numericalFailure);
  EXPECT_THAT(summary.reason, AllOf(HasSubstr("may move as a whole in 3 directions"), HasSubstr("VERTEX_SE2"),
                                    HasSubstr("theta [rad]")));
}

/// One range leaves a point free along the circle it draws.
TEST(Diagnosis, NamesThePointOfASingleRange) {
  Graph graph = ring();
  graph.vertex<VertexSE2>(0).setFixed(true);
  graph.addVertex<VertexPoint>(1000, Vector<double, 2>(30.0, 0.0));
  graph.vertex<VertexSE2>(3).setEstimate(SE2<double>(20.0, 0.0, 0.3));
  graph.addEdge<EdgeRangeAnalytic>({3, 1000}, 7.0, weight(100.0));
  const Summary summary = optimize(graph, {.algorithm = "gn"});
  EXPECT_EQ(summary.status, Status::numericalFailure);
  EXPECT_THAT(summary.reason, AllOf(HasSubstr("vertex 1000 (VERTEX_POINT)"), HasSubstr("1 direction: y [m]"),
                                    HasSubstr("EDGE_RANGE_ANALYTIC 3 1000")));
  const Summary damped = optimize(graph, {.algorithm = "lm"});
  EXPECT_EQ(damped.status, Status::converged) << damped.reason;
}

TEST(Diagnosis, NamesAVertexWithoutInformation) {
  Graph graph = ring();
  graph.addVertex<VertexPoint>(1000, Vector<double, 2>(1.0, 1.0));
  graph.addEdge<EdgePoint>({1000}, Vector<double, 2>(0.0, 0.0), weight2(0.0));
  const Summary summary = optimize(graph, {.algorithm = "gn"});
  EXPECT_EQ(summary.status, Status::numericalFailure);
  EXPECT_THAT(summary.reason, AllOf(HasSubstr("vertex 1000 (VERTEX_POINT)"), HasSubstr("x [m]; y [m]")));
}

}  // namespace
}  // namespace quiver
