// Errors that are small differences of large numbers, as ranges to satellites are: rounding bounds how far the cost can
// fall, and every algorithm ends there "converged".
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>

#include "core_types.h"

namespace quiver {
namespace {

using namespace test;

/// Position [m] and clock error [m] of a receiver, relative to a reference nearby: the estimate itself is small.
class VertexReceiver : public BaseVertex<VertexReceiver, 4, Vector<double, 4>> {
 public:
  template <typename S>
  static Vector<S, 4> oplus(const Vector<S, 4>& x, const Vector<S, 4>& delta) {
    return x + delta;
  }
};

/// Distance to a satellite, plus the clock's error; the measurement is the satellite's position and the range.
class EdgePseudorange : public BaseEdge<EdgePseudorange, 1, Vector<double, 4>, VertexReceiver> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const Vector<S, 4>& m, const Vector<S, 4>& x) {
    using std::sqrt;
    const S dx = x[0] - m[0], dy = x[1] - m[1], dz = x[2] - m[2];
    return Vector<S, 1>(sqrt(dx * dx + dy * dy + dz * dz) + x[3] - m[3]);
  }
};

Graph receiver(double noise, unsigned seed) {
  auto registry = makeRegistry();
  registry->addVertex<VertexReceiver>("VERTEX_RECEIVER");
  registry->addEdge<EdgePseudorange>("EDGE_PSEUDORANGE");
  Graph graph(registry);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Vector<double, 4> truth(0.42, -0.17, 0.28, 0.031);
  graph.addVertex<VertexReceiver>(0, Vector<double, 4>(truth + Vector<double, 4>(300.0, -200.0, 150.0, 50.0)));
  for (int i = 0; i < 8; ++i) {
    Vector<double, 3> direction(normal(random), normal(random), 2.0 + std::abs(normal(random)));
    const Vector<double, 3> satellite = truth.head<3>() + 2.2e7 * direction.normalized();
    Vector<double, 4> m;
    m << satellite, (satellite - truth.head<3>()).norm() + truth[3] + noise * normal(random);
    graph.addEdge<EdgePseudorange>({0}, m, weight(1.0 / 9.0));
  }
  return graph;
}

TEST(LargeConstants, EveryAlgorithmConverges) {
  for (const double noise : {3.0, 0.0}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      double lowest = 0.0;
      for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
        Graph graph = receiver(noise, seed);
        Options options;
        options.algorithm = algorithm;
        const Summary summary = optimize(graph, options);
        EXPECT_EQ(summary.status, Status::converged) << algorithm << ": " << summary.reason;
        EXPECT_LE(summary.iterations.size(), 30u) << algorithm;
        if (algorithm == std::string("auto")) lowest = summary.finalCost;
        EXPECT_NEAR(summary.finalCost, lowest, 1e-6 * lowest + 1e-13) << algorithm;
      }
    }
  }
}

TEST(LargeConstants, AnOptimumIsOneForTheNextSolveToo) {
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph graph = receiver(0.0, 3);
    Options options;
    options.algorithm = algorithm;
    (void)optimize(graph, options);
    const Summary again = optimize(graph, options);
    EXPECT_EQ(again.status, Status::converged) << algorithm << ": " << again.reason;
    EXPECT_LE(again.finalCost, again.initialCost);
  }
}

/// Residuals that are small in their units are not at rest because of that.
TEST(LargeConstants, TinyWeightsAreNoRest) {
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph heavy = receiver(3.0, 5), light(heavy);
    light.forEachEdge([](Edge& edge) { static_cast<EdgePseudorange&>(edge).setInformation(weight(1e-16)); });
    Options options;
    options.algorithm = algorithm;
    (void)optimize(heavy, options);
    const Summary summary = optimize(light, options);
    EXPECT_EQ(summary.status, Status::converged) << algorithm << ": " << summary.reason;
    const Vector<double, 4> x = heavy.vertex<VertexReceiver>(0).estimate();
    EXPECT_LT((light.vertex<VertexReceiver>(0).estimate() - x).norm(), 1e-3) << algorithm;
  }
}

}  // namespace
}  // namespace quiver
