#include <quiver/core/algorithm/optimizer.h>

#include <cmath>
#include <limits>
#include <stop_token>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/util/error.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Range = EdgeRangeDualLanes;

Vector<double, 2> point(double x, double y) { return Vector<double, 2>(x, y); }

/// Free points 0 … count − 1, each measured at (id, 1).
Graph points(int count) {
  Graph graph(makeRegistry());
  for (int id = 0; id < count; ++id) {
    graph.addVertex<VertexPoint>(id, point(5.0, 5.0));
    graph.addEdge<EdgePoint>({id}, point(id, 1.0), weight2());
  }
  return graph;
}

TEST(Status, Converged) {
  for (const char* algorithm : {"auto", "gn", "lm"}) {
    Graph graph = ringGraph<Range>(20, 4);
    const Summary summary = optimize(graph, {.algorithm = algorithm});
    EXPECT_EQ(summary.status, Status::converged) << summary.reason;
    EXPECT_LT(summary.finalChi2, summary.initialChi2);
    EXPECT_EQ(summary.finalChi2, summary.finalCost) << "without kernels";
  }
}

TEST(Status, IterationLimit) {
  Graph graph = ringGraph<Range>(20, 4);
  const Summary summary = optimize(graph, {.maxIterations = 1});
  EXPECT_EQ(summary.status, Status::iterationLimit);
  EXPECT_EQ(summary.iterations.size(), 1U);
  EXPECT_LT(summary.finalChi2, summary.initialChi2);
}

TEST(Status, TimeLimit) {
  Graph graph = ringGraph<Range>(20, 4);
  const auto before = estimates(graph, 20, 4);
  const Summary summary = optimize(graph, {.timeLimit = 1e-9});
  EXPECT_EQ(summary.status, Status::timeLimit);
  EXPECT_EQ(estimates(graph, 20, 4), before);
  EXPECT_EQ(summary.plan.algorithm, "gn") << "what would have been run";
}

TEST(Status, Interrupted) {
  Graph graph = ringGraph<Range>(20, 4);
  std::stop_source source;
  Options options;
  options.stopToken = source.get_token();
  options.callback = [&](const IterationReport&) { source.request_stop(); };
  const Summary summary = optimize(graph, options);
  EXPECT_EQ(summary.status, Status::interrupted);
  EXPECT_EQ(summary.iterations.size(), 1U);
  EXPECT_LT(summary.finalChi2, summary.initialChi2) << "the best estimate is kept";
}

TEST(Status, StalledByAWrongJacobian) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, point(1.0, 2.0));
  graph.addEdge<EdgeWrong>({0}, point(0.0, 0.0), weight2());
  const Summary summary = optimize(graph, {.maxIterations = 1000, .algorithm = "lm"});
  EXPECT_EQ(summary.status, Status::stalled);
  EXPECT_THAT(summary.reason, HasSubstr("checkJacobians"));
  EXPECT_EQ(graph.vertex<VertexPoint>(0).estimate(), point(1.0, 2.0));
}

TEST(Status, NumericalFailureNamesTheEdge) {
  Graph graph = points(2);
  graph.addEdge<EdgePoint>({1}, point(std::numeric_limits<double>::quiet_NaN(), 0.0), weight2());
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::numericalFailure);
  EXPECT_THAT(summary.reason, HasSubstr("EDGE_POINT 1 is not finite"));
}

TEST(Status, NothingToOptimise) {
  Graph empty(makeRegistry());
  EXPECT_EQ(optimize(empty).status, Status::nothingToOptimise);
  Graph graph = points(3);
  for (int id = 0; id < 3; ++id) graph.vertex<VertexPoint>(id).setFixed(true);
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::nothingToOptimise);
  EXPECT_GT(summary.finalChi2, 0.0);
  EXPECT_THAT(summary.reason, HasSubstr("fixed"));
}

TEST(Optimize, RefusesOptionsThatMakeNoSense) {
  Graph graph = points(1);
  EXPECT_THROW((void)optimize(graph, {.maxIterations = -1}), GraphError);
  EXPECT_THROW((void)optimize(graph, {.algorithm = "newton"}), GraphError);
  EXPECT_THROW((void)optimize(graph, {.linearSolver = "magic"}), GraphError);
  EXPECT_THROW((void)optimize(graph, {.free = {99}}), GraphError);
}

TEST(Optimize, HoldsFixedVerticesToTheLastBit) {
  Graph graph = ringGraph<Range>(20, 4);
  graph.vertex<VertexSE2>(0).setFixed(true);
  graph.vertex<VertexSE2>(10).setFixed(true);
  graph.vertex<VertexPoint>(1002).setFixedDirections(0b01);
  graph.vertex<VertexSE2>(5).setFixedDirections(0b100);
  const auto before = estimates(graph, 20, 4);
  ASSERT_EQ(optimize(graph).status, Status::converged);
  const auto after = estimates(graph, 20, 4);
  for (const std::size_t i : {0U, 1U, 2U, 30U, 31U, 32U, 17U, 64U}) EXPECT_EQ(after[i], before[i]) << i;
  for (const std::size_t i : {15U, 16U, 65U, 3U}) EXPECT_NE(after[i], before[i]) << i;
}

TEST(Optimize, TakesEdgesOfOneLevel) {
  Graph graph = points(1);
  graph.addEdge<EdgePoint>({0}, point(10.0, 11.0), weight2()).setLevel(1);
  (void)optimize(graph);
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[1], 1.0, 1e-12);
  (void)optimize(graph, {.level = 1});
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[1], 11.0, 1e-12);
  (void)optimize(graph, {.level = -1});
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[1], 6.0, 1e-12);
}

TEST(Optimize, MovesOnlyASubset) {
  Graph graph = ringGraph<Range>(20, 4);
  const auto before = estimates(graph, 20, 4);
  const Summary summary = optimize(graph, {.free = {3, 1001}});
  EXPECT_EQ(summary.variables, 2);
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  const auto after = estimates(graph, 20, 4);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool moves = (i >= 9 && i < 12) || i == 62 || i == 63;
    EXPECT_EQ(after[i] != before[i], moves) << i;
  }
}

TEST(Optimize, ListsVerticesThatNoEdgeTouches) {
  Graph graph = points(2);
  graph.addVertex<VertexPoint>(7);
  graph.addVertex<VertexPoint>(5, point(1.0, 1.0));
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::converged);
  EXPECT_THAT(summary.isolated, ElementsAre(5, 7));
}

TEST(Optimize, ParallelEdgesAreSummed) {
  Graph graph = points(1);
  graph.addEdge<EdgePoint>({0}, point(6.0, 1.0), weight2(2.0));
  (void)optimize(graph);
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[0], 4.0, 1e-12);
}

TEST(Optimize, ReportsEveryTrialToTheCallback) {
  Graph graph = ringGraph<Range>(20, 4);
  std::vector<IterationReport> reports;
  Options options;
  options.callback = [&](const IterationReport& report) { reports.push_back(report); };
  const Summary summary = optimize(graph, options);
  ASSERT_EQ(reports.size(), summary.iterations.size());
  for (std::size_t i = 0; i < reports.size(); ++i) EXPECT_EQ(reports[i].iteration, static_cast<int>(i));
  EXPECT_EQ(reports.back().chi2, summary.finalChi2);
}

TEST(Optimize, RobustKernelsLimitOutliers) {
  Graph graph = points(1);
  for (int i = 0; i < 9; ++i) graph.addEdge<EdgePoint>({0}, point(0.0, 1.0), weight2());
  auto& outlier = graph.addEdge<EdgePoint>({0}, point(1000.0, 1.0), weight2());
  outlier.setRobustKernel(RobustKernelHuber(1.0));
  const Summary summary = optimize(graph, {.maxIterations = 500});
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  // Ten inliers at 0 pull with 10 x, the outlier with its width, 1: x = 1/10.
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[0], 0.1, 1e-6);
  EXPECT_LT(summary.finalCost, summary.finalChi2);
}

TEST(Optimize, ParametersAndMembersReachTheError) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, point(0.0, 0.0));
  graph.addParameter<ParameterShift>(0, point(3.0, -1.0));
  auto& edge = graph.addEdge<EdgeShifted>({0}, point(7.0, 7.0), weight2(), {0});
  edge.gain = 2.0;
  (void)optimize(graph);
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[0], 2.0, 1e-9);
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[1], 4.0, 1e-9);
}

TEST(Optimize, EdgesOfAnyNumberOfVertices) {
  Graph graph = points(4);
  for (const auto& ids : {std::vector<std::int64_t>{0, 1, 2, 3}, std::vector<std::int64_t>{2}})
    graph.addEdge<EdgeMean>(ids, point(0.0, 5.0), weight2(100.0));
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  // The normal equations, y alone: a point y_i, i ≠ 2, has y_i − 1 + 25 (m − 5) = 0; point 2 also + 100 (y_2 − 5).
  double y[4];
  for (int i = 0; i < 4; ++i) y[i] = graph.vertex<VertexPoint>(i).estimate()[1];
  const double pull = 25.0 * ((y[0] + y[1] + y[2] + y[3]) / 4.0 - 5.0);
  EXPECT_NEAR(y[0] - 1.0 + pull, 0.0, 1e-9);
  EXPECT_NEAR(y[2] - 1.0 + 100.0 * (y[2] - 5.0) + pull, 0.0, 1e-8);
}

TEST(Optimize, DimensionsKnownAtRunTime) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 3; ++id) {
    const int n = 1 + 4 * id;
    graph.addVertex<VertexNumbers>(id, Vector<double, Dynamic>::LinSpaced(n, 1.0, 2.0));
    graph.addEdge<EdgeSquares>({id}, 4.0, Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n)));
  }
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  for (int id = 0; id < 3; ++id) {
    const Vector<double, Dynamic> x = graph.vertex<VertexNumbers>(id).estimate();
    for (const double value : x) EXPECT_NEAR(value, 2.0, 1e-9);
  }
}

TEST(Optimizer, ReusesItsStructure) {
  Graph graph = ringGraph<Range>(20, 4);
  Graph twin(graph);
  Optimizer optimizer;
  const Summary first = optimizer.optimize(graph);
  EXPECT_FALSE(optimizer.reused());
  for (int id = 0; id < 20; ++id) graph.vertex<VertexSE2>(id).setEstimate(twin.vertex<VertexSE2>(id).estimate());
  for (int id = 1000; id < 1004; ++id)
    graph.vertex<VertexPoint>(id).setEstimate(twin.vertex<VertexPoint>(id).estimate());
  const Summary second = optimizer.optimize(graph);
  EXPECT_TRUE(optimizer.reused());
  EXPECT_EQ(second.finalChi2, first.finalChi2);
  graph.vertex<VertexSE2>(3).setFixed(true);
  (void)optimizer.optimize(graph);
  EXPECT_FALSE(optimizer.reused());
}

TEST(MovedOptimizer, KnowsNothingAndServesAgain) {
  Graph graph = ringGraph<EdgeRangeDual>(20, 4);
  Optimizer optimizer;
  (void)optimizer.optimize(graph);
  Optimizer other = std::move(optimizer);
  (void)other.optimize(graph);
  EXPECT_TRUE(other.reused());
  EXPECT_FALSE(optimizer.reused());
  EXPECT_TRUE(optimizer.optimize(graph).converged());
}

TEST(Options, NameKnownTypesEvenForOneVariable) {
  Graph graph = points(1);
  Options options;
  options.elimination = EliminationPolicy::types;
  options.eliminatedTypes = {"VERTEX_NOWHERE"};
  EXPECT_THROW((void)optimize(graph, options), GraphError);
}

TEST(Options, SayWhichLevelsThereAre) {
  Graph graph = points(1);
  EXPECT_THAT([&] { (void)optimize(graph, {.level = -2}); },
              ::testing::ThrowsMessage<GraphError>(HasSubstr("-1 for all")));
}

}  // namespace
}  // namespace quiver
