// Solving again with an Optimizer: what was compiled before must never hide what has changed since.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam2d/edge_se2_prior.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using Range = EdgeRangeAnalyticLanes;

template <typename E>
E& firstEdge(Graph& graph) {
  E* found = nullptr;
  graph.forEachEdge([&](Edge& edge) {
    if (!found && graph.typeOf(edge).cppName() == typeName<E>()) found = static_cast<E*>(&edge);
  });
  return *found;
}

/// Optimises, lets `change` loose on the graph and optimises again with the same optimizer and with a new one.
void expectSeen(const std::function<void(Graph&)>& change, bool structure) {
  Graph graph = ringGraph<Range>(20, 4);
  Optimizer optimizer;
  const double before = optimizer.optimize(graph).finalCost;
  change(graph);
  Graph twin(graph);
  const double again = optimizer.optimize(graph).finalCost;
  EXPECT_EQ(optimizer.reused(), !structure);
  EXPECT_EQ(again, optimize(twin).finalCost);
  EXPECT_NE(again, before);
  EXPECT_EQ(estimates(graph, 20, 4), estimates(twin, 20, 4));
}

TEST(Reuse, SeesMeasurements) {
  expectSeen([](Graph& graph) { firstEdge<Range>(graph).setMeasurement(3.0); }, false);
  expectSeen([](Graph& graph) { firstEdge<EdgeSE2>(graph).setMeasurement(SE2<double>(1.0, 2.0, 0.3)); }, false);
}

TEST(Reuse, SeesInformation) {
  expectSeen([](Graph& graph) { firstEdge<EdgeSE2>(graph).setInformation(weight3(7.0)); }, false);
  // All matrices were diagonal before.
  Matrix<double, 3, 3> full = weight3(7.0);
  full(0, 1) = full(1, 0) = 2.0;
  expectSeen([&](Graph& graph) { firstEdge<EdgeSE2>(graph).setInformation(full); }, false);
  expectSeen(
      [&](Graph& graph) {
        EdgeSE2& edge = firstEdge<EdgeSE2>(graph);
        graph.typeOf(edge).setInformation(edge, std::vector<double>{3.0, 1.0, 0.0, 3.0, 0.0, 3.0});
      },
      false);
}

TEST(Reuse, SeesKernels) {
  // The first kernel changes the algorithm and with it the gauge.
  expectSeen(
      [](Graph& graph) {
        firstEdge<Range>(graph).setMeasurement(9.0);
        firstEdge<Range>(graph).setRobustKernel(RobustKernelHuber(0.1));
      },
      true);
  Graph graph = ringGraph<Range>(20, 4);
  Range& edge = firstEdge<Range>(graph);
  edge.setMeasurement(9.0);
  edge.setRobustKernel(RobustKernelHuber(0.1));
  Optimizer optimizer;
  (void)optimizer.optimize(graph);
  edge.setRobustKernel(RobustKernelHuber(0.3));
  Graph twin(graph);
  const double again = optimizer.optimize(graph).finalCost;
  EXPECT_TRUE(optimizer.reused());
  EXPECT_EQ(again, optimize(twin).finalCost);
}

TEST(Reuse, SeesRunTimeDimensions) {
  Graph graph(makeRegistry());
  using Numbers = Vector<double, Dynamic>;
  const auto square = [&](std::int64_t id, int n) {
    graph.addVertex<VertexNumbers>(id, Numbers::LinSpaced(n, 1.0, 2.0));
    graph.addEdge<EdgeSquares>({id}, 3.0, Matrix<double, Dynamic, Dynamic>::Identity(n, n));
  };
  square(0, 2);
  square(1, 3);
  Optimizer optimizer;
  EXPECT_EQ(optimizer.optimize(graph).plan.scalars, 5);
  graph.vertex<VertexNumbers>(0).setEstimate(Numbers::LinSpaced(9, 1.0, 2.0));
  firstEdge<EdgeSquares>(graph).setInformation(Matrix<double, Dynamic, Dynamic>::Identity(9, 9));
  EXPECT_EQ(optimizer.optimize(graph).plan.scalars, 12);
  EXPECT_NEAR(graph.vertex<VertexNumbers>(0).estimate()[8], std::sqrt(3.0), 1e-9);
}

TEST(Reuse, SeesWeightsThatMakeTheGauge) {
  Graph graph = ringGraph<Range>(20, 4);
  firstEdge<EdgeSE2>(graph).setInformation(weight3(0.0));
  Optimizer optimizer;
  (void)optimizer.optimize(graph);
  firstEdge<EdgeSE2>(graph).setInformation(weight3(7.0));
  (void)optimizer.optimize(graph);
  EXPECT_FALSE(optimizer.reused());
}

/// Poses in a row with a prior of the given weight on one of them.
Graph rowWithPrior(const Matrix<double, 3, 3>& weight) {
  Graph graph(builtinRegistry());
  for (int i = 0; i < 8; ++i) graph.addVertex<VertexSE2>(i, SE2<double>(i + 0.1 * (i % 3), 0.3 * (i % 2), 0.05));
  for (int i = 0; i < 7; ++i) graph.addEdge<EdgeSE2>({i, i + 1}, SE2<double>(1.02, 0.03 * (i % 2), 0.01), weight3());
  graph.addEdge<EdgeSE2>({0, 7}, SE2<double>(7.1, 0.1, 0.02), weight3());
  graph.addEdge<EdgePriorSE2>({3}, SE2<double>(3.0, 1.0, 0.2), weight);
  return graph;
}

void expectSameAsFresh(Optimizer& optimizer, Graph& graph) {
  Graph twin(graph);
  const Summary fresh = optimize(twin, optimizer.options());
  const Summary& kept = optimizer.optimize(graph);
  EXPECT_EQ(kept.status, fresh.status) << kept.reason << " instead of " << fresh.reason;
  EXPECT_EQ(kept.gauge.reason, fresh.gauge.reason);
  EXPECT_NEAR(kept.finalCost, fresh.finalCost, 1e-9 * (1.0 + fresh.finalCost));
}

TEST(Reuse, FindsTheGaugeOfInformationThatHasChanged) {
  const Matrix<double, 3, 3> rankOne = Matrix<double, 3, 3>::Ones();
  for (const char* algorithm : {"gn", "lm", "dogleg", "auto"}) {
    Graph graph = rowWithPrior(weight3());
    Optimizer optimizer({.algorithm = algorithm});
    (void)optimizer.optimize(graph);
    for (const Matrix<double, 3, 3>& weight : {rankOne, weight3(1e-18), weight3(), rankOne}) {
      firstEdge<EdgePriorSE2>(graph).setInformation(weight);
      graph.forEachVertex([](Vertex& vertex) {
        static_cast<VertexSE2&>(vertex).setEstimate(SE2<double>(vertex.id(), 0.2 * (vertex.id() % 2), 0.05));
      });
      SCOPED_TRACE(algorithm);
      expectSameAsFresh(optimizer, graph);
    }
  }
}

TEST(Reuse, DoubtsTheGaugeOfOtherEstimates) {
  Graph graph(builtinRegistry());
  for (int i = 0; i < 4; ++i) graph.addVertex<VertexSE2>(i, SE2<double>(i, 0.1 * i, 0.1));
  for (int i = 0; i < 3; ++i) graph.addEdge<EdgeSE2>({i, i + 1}, SE2<double>(1.0, 0.05, 0.05), weight3());
  for (const int i : {0, 3}) graph.addEdge<EdgePriorSE2XY>({i}, Vector<double, 2>(i, 0.3 * i), weight2());
  Optimizer optimizer({.algorithm = "gn"});
  (void)optimizer.optimize(graph);
  // On one spot, the world may turn about it.
  for (int i = 0; i < 4; ++i) graph.vertex<VertexSE2>(i).setEstimate(SE2<double>());
  expectSameAsFresh(optimizer, graph);
}

TEST(Reuse, IgnoresKernelsThatTakeNoPart) {
  Graph graph = rowWithPrior(weight3(0.0));
  Edge& idle = graph.addEdge<EdgeSE2>({0, 5}, SE2<double>(5.0, 0.0, 0.0), weight3());
  idle.setLevel(1);
  idle.setRobustKernel(RobustKernelHuber(1.0));
  Optimizer optimizer({.level = 0});
  (void)optimizer.optimize(graph);
  graph.forEachEdge([](Edge& edge) { edge.setRobustKernel(RobustKernelHuber(1.0)); });
  expectSameAsFresh(optimizer, graph);
}

TEST(Reuse, ForgetsWhatCouldNotBeCompiled) {
  Graph graph = ringGraph<Range>(20, 4);
  Optimizer optimizer;
  (void)optimizer.optimize(graph);
  graph.vertex<VertexSE2>(3).setEstimate(SE2<double>(1.0, 1.0, 1.0));
  graph.vertex<VertexSE2>(3).setFixed(true);
  optimizer.options().free = {99999};
  EXPECT_THROW((void)optimizer.optimize(graph), GraphError);
  optimizer.options().free = {};
  (void)optimizer.optimize(graph);
  graph.vertex<VertexSE2>(3).setFixed(false);
  Graph twin(graph);
  EXPECT_EQ(optimizer.optimize(graph).finalCost, optimize(twin).finalCost);
  // An analysis that throws leaves nothing half made.
  Optimizer strict({.algorithm = "lm", .elimination = EliminationPolicy::types, .eliminatedTypes = {"VERTEX_X"}});
  for (int call = 0; call < 3; ++call) EXPECT_THROW((void)strict.optimize(graph), GraphError);
}

TEST(Reuse, SeesOptionsOfLinearSolvers) {
  Graph graph = ringGraph<Range>(20, 4);
  Optimizer optimizer({.linearSolver = "pcg"});
  (void)optimizer.optimize(graph);
  optimizer.options().linearTolerance = 1e-2;
  (void)optimizer.optimize(graph);
  EXPECT_FALSE(optimizer.reused());
}

TEST(Reuse, SeesWhatChangesInACopy) {
  const Graph original = ringGraph<Range>(20, 4);
  Graph copy(original);
  Graph moved = std::move(copy);
  Optimizer optimizer;
  const double before = optimizer.optimize(moved).finalCost;
  // An element's copy belongs to no graph, even when the original's graph is gone.
  Range lost = firstEdge<Range>(moved);
  lost.setMeasurement(8.0);
  EXPECT_EQ(optimizer.optimize(moved).initialCost, before);
  firstEdge<Range>(moved).setMeasurement(8.0);
  EXPECT_NE(optimizer.optimize(moved).initialCost, before);
  moved = original;
  lost.setMeasurement(9.0);
}

TEST(Reuse, TellsOptimizersOfOneGraphEach) {
  Graph graph = ringGraph<Range>(20, 4);
  Optimizer first, second;
  (void)first.optimize(graph);
  (void)second.optimize(graph);
  firstEdge<Range>(graph).setMeasurement(8.0);
  EXPECT_GT(first.optimize(graph).initialCost, 1.0);
  Graph twin(graph);
  const Summary& again = second.optimize(graph);
  EXPECT_TRUE(second.reused());
  EXPECT_EQ(again.initialCost, optimize(twin).initialCost);
}

TEST(Reuse, SeesLevelsAndFixedVertices) {
  expectSeen([](Graph& graph) { firstEdge<Range>(graph).setLevel(1); }, true);
  expectSeen(
      [](Graph& graph) {
        graph.vertex<VertexSE2>(3).setEstimate(SE2<double>(1.0, 1.0, 1.0));
        graph.vertex<VertexSE2>(3).setFixed(true);
      },
      true);
}

TEST(Reuse, SeesAnEdgeInThePlaceOfAnother) {
  expectSeen(
      [](Graph& graph) {
        Range& edge = firstEdge<Range>(graph);
        const std::vector<std::int64_t> ids(edge.vertexIds().begin(), edge.vertexIds().end());
        const void* place = &edge;
        graph.removeEdge(edge);
        EXPECT_EQ(&graph.addEdge<Range>(ids, 3.0, weight(400.0)), place);
      },
      true);
}

TEST(Reuse, SeesParameters) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(5.0, 5.0));
  auto& shift = graph.addParameter<ParameterShift>(1, Vector<double, 2>(1.0, 0.0));
  graph.addEdge<EdgeShifted>({0}, Vector<double, 2>(3.0, 4.0), weight2(), {1});
  Optimizer optimizer;
  EXPECT_LT(optimizer.optimize(graph).finalCost, 1e-20);
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[0], 2.0, 1e-9);
  shift.setValue(Vector<double, 2>(-1.0, 0.0));
  EXPECT_LT(optimizer.optimize(graph).finalCost, 1e-20);
  EXPECT_TRUE(optimizer.reused());
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[0], 4.0, 1e-9);
}

TEST(Reuse, TellsGraphsApartThatLieAtOneAddress) {
  Optimizer optimizer;
  alignas(Graph) unsigned char memory[sizeof(Graph)];
  for (const double target : {1.0, 2.0, 3.0}) {
    // Built alike, so pools are likely to lie where those of the one before did.
    Graph* graph = new (memory) Graph(makeRegistry());
    graph->addVertex<VertexPoint>(0, Vector<double, 2>(5.0, 5.0));
    graph->addEdge<EdgePoint>({0}, Vector<double, 2>(target, target), weight2());
    (void)optimizer.optimize(*graph);
    EXPECT_FALSE(optimizer.reused());
    EXPECT_NEAR(graph->vertex<VertexPoint>(0).estimate()[0], target, 1e-12);
    graph->~Graph();
  }
  Graph graph(makeRegistry());
  for (const double target : {1.0, 2.0, 3.0}) {
    Graph other(makeRegistry());
    other.addVertex<VertexPoint>(0, Vector<double, 2>(5.0, 5.0));
    other.addEdge<EdgePoint>({0}, Vector<double, 2>(target, target), weight2());
    graph = other;
    (void)optimizer.optimize(graph);
    EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[0], target, 1e-12);
  }
}

TEST(Reuse, FindsAProblemCompiledBefore) {
  Graph graph = ringGraph<Range>(20, 4);
  Graph twin(graph);
  Optimizer optimizer;
  Problem& problem = optimizer.compile(graph);
  const double chi2 = problem.evaluate(problem.state()).chi2;
  const Summary& summary = optimizer.optimize(graph);
  EXPECT_FALSE(optimizer.reused()) << "compiled, but never solved";
  EXPECT_EQ(summary.initialChi2, chi2);
  EXPECT_EQ(summary.finalChi2, optimize(twin).finalChi2);
}

}  // namespace
}  // namespace quiver
