// Functions of the user's that run during a solve.
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/estimates.h>

#include "core_types.h"
#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Graph ring() { return ringGraph<EdgeRangeDual>(12, 4); }

/// Solves with a callback that does something after the second step.
template <typename Change>
void solveWith(Optimizer& optimizer, Graph& graph, Change change) {
  int calls = 0;
  optimizer.options().callback = [&](const IterationReport&) {
    if (++calls == 2) change(graph);
  };
  try {
    (void)optimizer.optimize(graph);
  } catch (...) {
    optimizer.options().callback = {};
    throw;
  }
  optimizer.options().callback = {};
}

template <typename Change>
void expectRefused(Change change) {
  Graph graph = ring();
  Optimizer optimizer({.algorithm = "lm", .threads = 1});
  (void)optimizer.optimize(graph);
  copyEstimates(ring(), graph);
  EXPECT_THAT([&] { solveWith(optimizer, graph, change); },
              ThrowsMessage<GraphError>(HasSubstr("the callback changed the graph")));
  // What was compiled is gone; the graph that is there now is solved.
  Graph copy(graph);
  const Summary again = optimizer.optimize(graph);
  const Summary fresh = optimize(copy, {.algorithm = "lm", .threads = 1});
  EXPECT_EQ(again.status, Status::converged) << again.reason;
  EXPECT_EQ(again.finalCost, fresh.finalCost);
}

TEST(Callback, ThatChangesTheGraphIsRefused) {
  expectRefused([](Graph& graph) { graph.removeVertex(3); });
  expectRefused([](Graph& graph) { graph = ring(); });
  expectRefused([other = ring()](Graph& graph) { graph = other; });
  expectRefused([](Graph& graph) { graph.findVertex(2)->setFixed(true); });
  expectRefused([](Graph& graph) { graph.forEachEdge([](Edge& edge) { edge.setLevel(edge.level()); }); });
}

TEST(Callback, ThatThrowsKeepsTheEstimate) {
  Graph graph = ring();
  const double before = optimize(graph, {.maxIterations = 0}).initialCost;
  Optimizer optimizer({.algorithm = "lm", .threads = 1});
  double reached = std::numeric_limits<double>::quiet_NaN();
  optimizer.options().callback = [&](const IterationReport& report) {
    reached = report.cost;
    if (report.iteration == 1) throw std::runtime_error("enough");
  };
  EXPECT_THROW((void)optimizer.optimize(graph), std::runtime_error);
  optimizer.options().callback = {};
  const double kept = optimize(graph, {.maxIterations = 0}).initialCost;
  EXPECT_LT(kept, before);
  EXPECT_NEAR(kept, reached, 1e-12 * reached);
  EXPECT_EQ(optimizer.optimize(graph).status, Status::converged);
}

TEST(Callback, ThatResizesAnEstimateIsRefused) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexNumbers>(0, Vector<double, Dynamic>::Constant(2, 3.0));
  graph.addEdge<EdgeSquares>({0}, 2.0, Matrix<double, Dynamic, Dynamic>::Identity(2, 2));
  Options options;
  options.callback = [&](const IterationReport&) {
    graph.vertex<VertexNumbers>(0).setEstimate(Vector<double, Dynamic>::Constant(90, 1.0));
  };
  EXPECT_THAT([&] { (void)optimize(graph, options); },
              ThrowsMessage<GraphError>(HasSubstr("the callback changed the graph")));
}

TEST(PhaseFunction, ThatChangesTheGraphIsRefused) {
  Graph graph = ring();
  Options options;
  options.phase = [&](std::string_view) { graph.removeVertex(4); };
  EXPECT_THAT([&] { (void)optimize(graph, options); },
              ThrowsMessage<GraphError>(HasSubstr("the function told of phases changed the graph")));
}

}  // namespace
}  // namespace quiver
