// Coordinates whose own size is far below 1: differences, in solves and in checks, must find a step that fits.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/algorithm/optimizer.h>

#include "core_types.h"

namespace quiver {
namespace {

using test::VertexNumbers;

class Pair : public BaseVertex<Pair, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
};

/// a e^{−kt} − y of (t, y).
template <typename S, typename Estimate>
S decay(const Vector<S, 2>& m, const Estimate& x) {
  using std::exp;
  return x[0] * exp(-x[1] * m[0]) - m[1];
}
/// a sin(kt) − y.
template <typename S, typename Estimate>
S wave(const Vector<S, 2>& m, const Estimate& x) {
  using std::sin;
  return x[0] * sin(x[1] * m[0]) - m[1];
}
/// The division model of radial distortion: a r / (1 + k r²) − y of (r, y), in pixels.
template <typename S, typename Estimate>
S division(const Vector<S, 2>& m, const Estimate& x) {
  return x[0] * m[0] / (S(1.0) + x[1] * m[0] * m[0]) - m[1];
}

enum class Curve { decay, wave, division };

template <Curve curve, typename S, typename Estimate>
Vector<S, 1> errorOf(const Vector<S, 2>& m, const Estimate& x) {
  switch (curve) {
    case Curve::decay:
      return Vector<S, 1>(decay(m, x));
    case Curve::wave:
      return Vector<S, 1>(wave(m, x));
    default:
      return Vector<S, 1>(division(m, x));
  }
}

template <Curve curve, Jacobians form>
class EdgeCurve : public BaseEdge<EdgeCurve<curve, form>, 1, Vector<double, 2>, Pair> {
 public:
  static constexpr Jacobians jacobians = form;
  template <typename S>
  static Vector<S, 1> computeError(const Vector<S, 2>& m, const Vector<S, 2>& x) {
    return errorOf<curve>(m, x);
  }
};

template <Curve curve>
class EdgeCurveOfNumbers : public BaseEdge<EdgeCurveOfNumbers<curve>, 1, Vector<double, 2>, VertexNumbers> {
 public:
  static constexpr Jacobians jacobians = Jacobians::numeric;
  template <typename S>
  static Vector<S, 1> computeError(const Vector<S, 2>& m, const Vector<S, Dynamic>& x) {
    return errorOf<curve>(m, x);
  }
};

/// A hundred measurements of a curve whose rate is k.
template <Curve curve>
std::vector<Vector<double, 2>> measured(double k) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vector<double, 2>> measurements;
  for (int i = 0; i < 100; ++i) {
    Vector<double, 2> m(curve == Curve::division ? 0.02 * i / std::sqrt(k) : 0.03 * i / k, 0.0);
    m[1] = errorOf<curve>(m, Vector<double, 2>(2.0, k))[0];
    m[1] *= 1.0 + 0.01 * normal(random);
    measurements.push_back(m);
  }
  return measurements;
}

template <typename Vertex, typename Edge>
Graph fit(const std::vector<Vector<double, 2>>& measurements, double k) {
  auto registry = test::makeRegistry();
  registry->addVertex<Pair>("PAIR");
  registry->addEdge<Edge>("EDGE");
  Graph graph(registry);
  typename Vertex::Estimate start(2);
  start << 1.6, 1.1 * k;
  graph.addVertex<Vertex>(0, start);
  for (const Vector<double, 2>& m : measurements) graph.addEdge<Edge>({0}, m, Matrix<double, 1, 1>(1e4));
  return graph;
}

template <Curve curve>
void expectSameOptimum(double k) {
  SCOPED_TRACE(k);
  const auto measurements = measured<curve>(k);
  Graph dual = fit<Pair, EdgeCurve<curve, Jacobians::automatic>>(measurements, k);
  Graph numeric = fit<Pair, EdgeCurve<curve, Jacobians::numeric>>(measurements, k);
  Graph dynamic = fit<VertexNumbers, EdgeCurveOfNumbers<curve>>(measurements, k);
  // Differences of differences are as good as their steps, those of dual numbers as good as one.
  EXPECT_LT(checkJacobians(dual).worstDeviation(), 1e-6) << checkJacobians(dual).describe();
  // Beyond that, a step short enough is within the rounding of the other coordinate: such columns are left out.
  if (k >= 1e-7) {
    EXPECT_EQ(checkJacobians(dual).types[0].jumps, 0);
  }
  EXPECT_LT(checkJacobians(numeric).worstDeviation(), 1e-3) << checkJacobians(numeric).describe();
  EXPECT_LT(checkJacobians(dynamic).worstDeviation(), 1e-3);
  (void)optimize(dual);
  EXPECT_EQ(optimize(numeric).status, Status::converged);
  EXPECT_EQ(optimize(dynamic).status, Status::converged);
  const Vector<double, 2> x = dual.vertex<Pair>(0).estimate();
  EXPECT_NEAR(x[1], k, 0.05 * k);
  const auto expectClose = [&](const auto& y) {
    EXPECT_NEAR(y[0], x[0], 1e-6 * std::abs(x[0]));
    EXPECT_NEAR(y[1], x[1], 1e-6 * std::abs(x[1]));
  };
  expectClose(numeric.vertex<Pair>(0).estimate());
  expectClose(dynamic.vertex<VertexNumbers>(0).estimate());
}

TEST(SmallCoordinates, NumericJacobiansFindTheOptimumOfDualNumbers) {
  for (const double k : {1.0, 1e-3, 1e-5, 1e-7, 1e-9}) {
    expectSameOptimum<Curve::decay>(k);
    expectSameOptimum<Curve::wave>(k);
    expectSameOptimum<Curve::division>(k);
  }
}

/// Wrong by a factor in its second column.
class EdgeWrongDecay : public BaseEdge<EdgeWrongDecay, 1, Vector<double, 2>, Pair> {
 public:
  static Vector<double, 1> computeError(const Vector<double, 2>& m, const Vector<double, 2>& x) {
    return Vector<double, 1>(decay(m, x));
  }
  static void linearizeOplus(const Vector<double, 2>& m, const Vector<double, 2>& x, Matrix<double, 1, 2>& J) {
    const double e = std::exp(-x[1] * m[0]);
    J << e, -0.9 * x[0] * m[0] * e;
  }
};

TEST(SmallCoordinates, WrongJacobiansAreFoundThere) {
  const Graph graph = fit<Pair, EdgeWrongDecay>(measured<Curve::decay>(1e-7), 1e-7);
  const JacobianReport report = checkJacobians(graph);
  EXPECT_NEAR(report.worstDeviation(), 0.1, 0.02);
  EXPECT_EQ(report.types[0].jumps, 0);
}

/// |x| has a kink, and a number far away only noise: neither has a better step.
class EdgeKink : public BaseEdge<EdgeKink, 2, double, Pair> {
 public:
  static constexpr Jacobians jacobians = Jacobians::numeric;
  static Vector<double, 2> computeError(const double& m, const Vector<double, 2>& x) {
    return Vector<double, 2>(std::abs(x[0]) - m, (x[1] + 1e9) - 1e9 - x[1] + x[0]);
  }
};

TEST(SmallCoordinates, KinksAndNoiseAreNoSlopes) {
  auto registry = test::makeRegistry();
  registry->addVertex<Pair>("PAIR");
  registry->addEdge<EdgeKink>("EDGE");
  Graph graph(registry);
  graph.addVertex<Pair>(0, Vector<double, 2>(2e-6, 0.25));
  graph.addEdge<EdgeKink>({0}, 1.0, Matrix<double, 2, 2>(Matrix<double, 2, 2>::Identity()));
  // Rounding of 1e9 is 1e-7: over the first step of 6e-6 a slope of 0.02, over the shortest one of 1e11.
  EXPECT_LT(optimize(graph, {.maxIterations = 3}).finalCost, 2.0);
  EXPECT_LT(std::abs(graph.vertex<Pair>(0).estimate()[1]), 1e6);
}

/// Rows in units of their own: a steep straight one beside one that bends within a millionth.
template <Jacobians form>
class EdgeUnits : public BaseEdge<EdgeUnits<form>, 2, Vector<double, 2>, Pair> {
 public:
  static constexpr Jacobians jacobians = form;
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& m, const Vector<S, 2>& x) {
    using std::sin;
    return Vector<S, 2>((x[0] - m[0]) * S(1e10), sin(x[0] * S(5e5)) + x[1] * S(1e-9) - m[1]);
  }
};

TEST(SmallCoordinates, RowsHaveStepsOfTheirOwn) {
  const auto solve = [](auto edge) {
    using Edge = decltype(edge);
    auto registry = test::makeRegistry();
    registry->addVertex<Pair>("PAIR");
    registry->addEdge<Edge>("EDGE");
    Graph graph(registry);
    graph.addVertex<Pair>(0, Vector<double, 2>(1e-6, 1.3e9));
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 40; ++i) {
      Matrix<double, 2, 2> information = Vector<double, 2>(1e-4, 1.0).asDiagonal();
      graph.addEdge<Edge>({0}, Vector<double, 2>(1.5e-6 + 1e-7 * normal(random), 2.2 + 0.01 * normal(random)),
                          information);
    }
    EXPECT_LT(checkJacobians(graph).worstDeviation(), 1e-6) << checkJacobians(graph).describe();
    const Summary summary = optimize(graph);
    EXPECT_EQ(summary.status, Status::converged) << summary.reason;
    return std::pair(summary.finalCost, graph.vertex<Pair>(0).estimate());
  };
  const auto [cost, x] = solve(EdgeUnits<Jacobians::automatic>());
  const auto [numericCost, y] = solve(EdgeUnits<Jacobians::numeric>());
  EXPECT_NEAR(numericCost, cost, 1e-9 * cost);
  EXPECT_NEAR(y[0], x[0], 1e-6 * std::abs(x[0]));
  EXPECT_NEAR(y[1], x[1], 1e-6 * std::abs(x[1]));
}

/// s (a − m) and s a; the second row's slope has the wrong sign.
class EdgeScaled : public BaseEdge<EdgeScaled, 2, Vector<double, 2>, Pair> {
 public:
  static Vector<double, 2> computeError(const Vector<double, 2>& m, const Vector<double, 2>& x) {
    return Vector<double, 2>(m[1] * (x[0] - m[0]), x[1]);
  }
  static void linearizeOplus(const Vector<double, 2>& m, const Vector<double, 2>& x, Matrix<double, 2, 2>& J) {
    J << (x[1] < 0.0 ? -m[1] : m[1]), 0.0, 0.0, (x[1] < 0.0 ? 1.0 : -1.0);
  }
};

TEST(SmallCoordinates, WrongSignsAreFoundAtEveryScale) {
  for (const double scale : {1e-9, 1e-7, 1e-3, 1.0, 1e3, 1e6}) {
    for (const double at : {1e-9, 1e-3, 1.0, 1e4, 1e7, 1e8}) {
      for (const double second : {-1.0, 1.0}) {  // the first row is wrong, or the second
        auto registry = test::makeRegistry();
        registry->addVertex<Pair>("PAIR");
        registry->addEdge<EdgeScaled>("EDGE");
        Graph graph(registry);
        graph.addVertex<Pair>(0, Vector<double, 2>(at, second));
        graph.addEdge<EdgeScaled>({0}, Vector<double, 2>(at + 0.3, scale), Matrix<double, 2, 2>::Identity());
        EXPECT_GT(checkJacobians(graph).worstDeviation(), 0.5)
            << scale << " " << at << " " << second << " " << checkJacobians(graph).describe();
      }
    }
  }
}

}  // namespace
}  // namespace quiver
