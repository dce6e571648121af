// Descents by an iterative linear solver: as few steps as with a direct one, and no memory of the descent before.
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

/// Poses one metre apart on an arc, their estimates on a line: the worst case for a preconditioner of blocks.
Graph chain(int poses) {
  Graph graph(makeRegistry());
  for (int id = 0; id < poses; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(id, 0.0, 0.0));
  for (int id = 0; id + 1 < poses; ++id)
    graph.addEdge<EdgeSE2>({id, id + 1}, SE2<double>(1.0, 0.01, 0.005), weight3(100.0));
  graph.vertex<VertexSE2>(0).setFixed(true);
  return graph;
}

void resetEstimates(Graph& graph, int poses) {
  for (int id = 0; id < poses; ++id) graph.vertex<VertexSE2>(id).setEstimate(SE2<double>(id, 0.0, 0.0));
}

TEST(IterativeSolver, NeedsNotManyMoreStepsThanADirectOne) {
  Graph direct = chain(300), iterative = chain(300);
  const Summary exact = optimize(direct, {.algorithm = "gn"});
  const Summary summary = optimize(iterative, {.algorithm = "gn", .linearSolver = "pcg"});
  EXPECT_TRUE(summary.converged()) << summary.reason;
  EXPECT_LE(summary.iterations.size(), exact.iterations.size() + 10);
  EXPECT_LT(summary.finalChi2, 1e-9);
}

TEST(IterativeSolver, BeginsEveryDescentAnew) {
  Graph graph = chain(40);
  Optimizer optimizer({.algorithm = "gn", .linearSolver = "pcg"});
  const std::size_t first = optimizer.optimize(graph).iterations.size();
  resetEstimates(graph, 40);
  Graph twin(graph);
  const Summary& again = optimizer.optimize(graph);
  EXPECT_TRUE(optimizer.reused());
  EXPECT_EQ(again.iterations.size(), first);
  const Summary fresh = optimize(twin, optimizer.options());
  ASSERT_EQ(again.iterations.size(), fresh.iterations.size());
  for (std::size_t i = 0; i < fresh.iterations.size(); ++i)
    EXPECT_EQ(again.iterations[i].linearIterations, fresh.iterations[i].linearIterations);
}

/// Where conjugate gradients stop at their limit they have a step all the same.
TEST(IterativeSolver, TakesUnfinishedStepsWhileTheyLowerTheCost) {
  Graph graph = chain(60);
  const Summary summary =
      optimize(graph, {.maxIterations = 3, .algorithm = "lm", .linearSolver = "pcg", .maxLinearIterations = 2});
  ASSERT_FALSE(summary.iterations.empty());
  EXPECT_TRUE(summary.iterations[0].accepted);
  EXPECT_EQ(summary.iterations[0].linearIterations, 2);
  EXPECT_LT(summary.finalCost, summary.initialCost);
}

}  // namespace
}  // namespace quiver
