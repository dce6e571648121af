// Costly errors and stop conditions: work ends within a pass over the edges, with the best estimate.
#include <atomic>
#include <chrono>
#include <cmath>
#include <stop_token>
#include <thread>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

std::atomic<int> calls{0};
std::atomic<int> stopAt{0};
std::stop_source source;

/// An error that takes two microseconds and asks for a stop in a call of its choice.
template <typename Error>
void beSlow(const Error&) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(2);
  while (std::chrono::steady_clock::now() < end) {
  }
  if (++calls == stopAt) source.request_stop();
}

class EdgeSlow : public BaseEdge<EdgeSlow, 2, Vector<double, 2>, VertexPoint> {
 public:
  static Vector<double, 2> computeError(const Vector<double, 2>& z, const Vector<double, 2>& x) {
    beSlow(x);
    return Vector<double, 2>(std::sinh(x[0] - z[0]), x[1] - z[1]);
  }
};

/// The same with a number of vertices known at run time.
class EdgeSlowMean : public BaseEdge<EdgeSlowMean, 2, Vector<double, 2>, AnyNumberOf<VertexPoint>> {
 public:
  static Vector<double, 2> computeError(const Vector<double, 2>& z, std::span<const Vector<double, 2>> x) {
    beSlow(x[0]);
    return Vector<double, 2>(std::sinh(x[0][0] - z[0]), x[0][1] - z[1]);
  }
};

constexpr int count = 300;

template <typename E>
Graph slowGraph() {
  auto registry = makeRegistry();
  registry->addEdge<E>("EDGE_SLOW");
  Graph graph(registry);
  for (int id = 0; id < count; ++id) {
    graph.addVertex<VertexPoint>(id, Vector<double, 2>(0.0, 0.0));
    graph.addEdge<E>({id}, Vector<double, 2>(2.0, 1.0), weight2());
  }
  return graph;
}

/// Stops in every phase of a solve in turn; returns the number of calls of a whole one.
template <typename E>
void stopEverywhere(int threads) {
  const auto run = [&](int at) {
    calls = 0;
    stopAt = at;
    source = {};
    Graph graph = slowGraph<E>();
    const Summary summary = optimize(graph, {.algorithm = "lm", .threads = threads, .stopToken = source.get_token()});
    if (at > 0) {
      EXPECT_EQ(summary.status, Status::interrupted) << at;
      // Each thread may be within an edge, and measuring what an edge costs is not stopped.
      EXPECT_LE(calls, at + 20 + 2 * threads) << "it went on";
    }
    double chi2 = 0.0;
    for (int id = 0; id < count; ++id) {
      const Vector<double, 2> x = graph.vertex<VertexPoint>(id).estimate();
      chi2 += std::pow(std::sinh(x[0] - 2.0), 2) + std::pow(x[1] - 1.0, 2);
    }
    if (std::isfinite(summary.finalChi2)) {
      EXPECT_NEAR(summary.finalChi2, chi2, 1e-9 * chi2 + 1e-9) << "the estimate left is the one told of";
      EXPECT_LE(summary.finalChi2, summary.initialChi2);
    }
    if (!summary.iterations.empty()) {
      EXPECT_EQ(summary.iterations.back().chi2, summary.finalChi2);
    }
    return calls.load();
  };
  const int all = run(0);
  ASSERT_GT(all, 5 * count);
  for (int at = 50; at < all - 2 * count; at += all / 23) run(at);
}

TEST(Stop, IsHonouredWithinPassesOverCostlyEdges) {
  stopEverywhere<EdgeSlow>(1);
  stopEverywhere<EdgeSlow>(2);
}

TEST(Stop, IsHonouredByEdgesOfRunTimeShape) { stopEverywhere<EdgeSlowMean>(2); }

TEST(Stop, AnOptimizerGoesOnAfterwards) {
  Graph graph = slowGraph<EdgeSlow>();
  for (const int at : {60, 400, 3000}) {
    Optimizer optimizer;
    calls = 0;
    stopAt = at;
    source = {};
    optimizer.options().stopToken = source.get_token();
    EXPECT_EQ(optimizer.optimize(graph).status, Status::interrupted);
    optimizer.options().stopToken = {};
    Graph twin(graph);
    const Summary& again = optimizer.optimize(graph);
    EXPECT_TRUE(again.converged()) << again.reason;
    EXPECT_EQ(again.finalCost, optimize(twin).finalCost);
    for (int id = 0; id < count; ++id) graph.vertex<VertexPoint>(id).setEstimate(Vector<double, 2>(0.0, 0.0));
  }
}

}  // namespace
}  // namespace quiver
