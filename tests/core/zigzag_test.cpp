// Descents that used to end, or never to end, where the cost still falls.

#include <cmath>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/registry/registry.h>
#include <quiver/quiver.h>

namespace quiver {
namespace {

struct VertexBeacon : BaseVertex<VertexBeacon, 2, Vector<double, 2>> {
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
};

/// The distance between two beacons: a circle of minima, whose derivative by a coordinate goes through zero.
struct EdgeRange : BaseEdge<EdgeRange, 1, double, VertexBeacon, VertexBeacon> {
  template <typename S>
  static Vector<S, 1> computeError(const S& range, const Vector<S, 2>& from, const Vector<S, 2>& to) {
    return Vector<S, 1>((to - from).norm() - range);
  }
};

std::shared_ptr<Registry> beacons() {
  const auto registry = builtinRegistry();
  registry->addVertex<VertexBeacon>("BEACON");
  registry->addEdge<EdgeRange>("RANGE");
  return registry;
}

using Point = Vector<double, 2>;
const Matrix<double, 1, 1> unit(1.0);

/// A beacon somewhere, at a range from one that is fixed somewhere else.
Graph oneRange(const std::shared_ptr<Registry>& registry, std::mt19937_64& random) {
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  Graph graph(registry);
  graph.addVertex<VertexBeacon>(0, Point(uniform(-6, 6), uniform(-6, 6)));
  graph.addVertex<VertexBeacon>(1, Point(uniform(-3, 3), uniform(-3, 3))).setFixed(true);
  graph.addEdge<EdgeRange>({1, 0}, uniform(0.5, 2.0), unit);
  return graph;
}

TEST(Zigzag, OneRangeIsMetFromAnywhere) {
  const auto registry = beacons();
  for (const std::string algorithm : {"auto", "lm"}) {
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 300; ++trial) {
      Graph graph = oneRange(registry, random);
      const Summary summary = optimize(graph, {.algorithm = algorithm});
      EXPECT_EQ(summary.status, Status::converged) << algorithm << " " << trial << ": " << summary.reason;
      EXPECT_LE(summary.finalCost, 1e-10) << algorithm << " " << trial;
    }
  }
}

/// A step that a radius has shortened says nothing about the end of the way.
TEST(Zigzag, DoglegConvergesOnlyWhereTheGradientDoes) {
  const auto registry = beacons();
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    Graph graph = oneRange(registry, random);
    const Summary summary = optimize(graph, {.algorithm = "dogleg", .costTolerance = 1e-3});
    if (summary.status == Status::converged) {
      EXPECT_LE(summary.finalCost, 1e-3) << trial << ": " << summary.reason;
    }
  }
}

/// y = a exp(b t): once a fits, the derivatives by b are smaller by many powers of ten, and a damping that remembers
/// them would hold b.
class EdgeGrowth : public BaseEdge<EdgeGrowth, 1, Vector<double, 2>, VertexBeacon> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const Vector<S, 2>& seen, const Vector<S, 2>& x) {
    using std::exp;
    return Vector<S, 1>(x[0] * exp(x[1] * seen[0]) - seen[1]);
  }
};

TEST(Zigzag, AFallOfTheDiagonalIsFollowed) {
  const auto registry = beacons();
  registry->addEdge<EdgeGrowth>("GROWTH");
  for (const std::string algorithm : {"lm", "dogleg"}) {
    for (const Point& start :
         {Point(10.0, 2.5), Point(1.0, 3.0), Point(100.0, 2.0), Point(0.1, 5.0), Point(0.1, 6.0)}) {
      Graph graph(registry);
      graph.addVertex<VertexBeacon>(0, start);
      for (int i = 0; i < 20; ++i) {
        const double t = 0.25 * i;
        graph.addEdge<EdgeGrowth>({0}, Point(t, 2.5 * std::exp(-0.7 * t) + 0.01 * ((i * 37) % 7 - 3)), unit);
      }
      const Summary summary = optimize(graph, {.maxIterations = 200, .algorithm = algorithm});
      // Those of dogleg may go to b = −∞, where the curve is a single number; 21 is what a alone can bring.
      const double least = algorithm == "lm" ? 0.0077 : 14.94;
      EXPECT_LE(summary.finalCost, least) << algorithm << start.transpose() << summary.reason;
      EXPECT_TRUE(summary.converged()) << algorithm << start.transpose() << summary.reason;
    }
  }
}

/// Full steps leap from one side of a valley to the other, and each second one is a little lower than any before.
TEST(Zigzag, AutomaticLeavesATwoCycle) {
  const auto registry = beacons();
  Graph graph(registry);
  graph.addVertex<VertexBeacon>(0, Point(-3.7, 2.6));
  const Point places[] = {{2.7, -1.1}, {-3.8, -2.1}, {2.8, 3.3}};
  const double ranges[] = {6.5, 0.1, 8.3};
  for (int i = 0; i < 3; ++i) {
    graph.addVertex<VertexBeacon>(i + 1, places[i]).setFixed(true);
    graph.addEdge<EdgeRange>({i + 1, 0}, ranges[i], unit);
  }
  Graph twin = graph;
  const Summary summary = optimize(graph);
  const Summary damped = optimize(twin, {.algorithm = "lm"});
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_NEAR(summary.finalCost, damped.finalCost, 1e-8 * damped.finalCost);
  EXPECT_LT(summary.iterations.size(), 40u);
}

/// The same with points of the library: three landmarks that do not agree where a pose is.
TEST(Zigzag, AutomaticLeavesATwoCycleOfAPose) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>());
  const Point places[] = {{2, -3}, {-3, 0}, {2, 0}};
  const Point seen[] = {{4, 3}, {4, -4}, {3, 2}};
  for (int i = 0; i < 3; ++i) {
    graph.addVertex<VertexXY>(i + 1, places[i]).setFixed(true);
    Matrix<double, 2, 2> information = Matrix<double, 2, 2>::Identity();
    information(1, 1) = i < 2 ? 10.0 : 1.0;
    graph.addEdge<EdgeSE2XY>({0, i + 1}, seen[i], information);
  }
  Graph twin = graph;
  const Summary summary = optimize(graph);
  const Summary damped = optimize(twin, {.algorithm = "lm"});
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_NEAR(summary.finalCost, damped.finalCost, 1e-8 * damped.finalCost);
}

}  // namespace
}  // namespace quiver
