#pragma once

#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include <Eigen/Dense>

#include <quiver/core/graph/graph.h>
#include <quiver/core/problem/problem.h>

namespace quiver::test {

/// D numbers.
template <int D>
class VertexOf : public BaseVertex<VertexOf<D>, D, Vector<double, D>> {
 public:
  template <typename S>
  static Vector<S, D> oplus(const Vector<S, D>& x, const Vector<S, D>& delta) {
    return x + delta;
  }
};

/// e = Σ A_i (x_i + x_i² / 8) − z with A and z in the measurement: N × D matrices row by row, then z.
template <bool inLanes, int N, int... D>
class EdgeMix : public BaseEdge<EdgeMix<inLanes, N, D...>, N, Vector<double, N*((0 + ... + D) + 1)>, VertexOf<D>...> {
 public:
  static constexpr bool lanes = inLanes;
  static constexpr int numbers = N * ((0 + ... + D) + 1);

  template <typename S>
  static Vector<S, N> computeError(const Vector<S, numbers>& m, const Vector<S, D>&... x) {
    Vector<S, N> error;
    for (int r = 0; r < N; ++r) error[r] = -m[numbers - N + r];
    int at = 0;
    (
        [&] {
          for (int r = 0; r < N; ++r) {
            for (int c = 0; c < D; ++c, ++at) error[r] += m[at] * (x[c] + x[c] * x[c] * S(0.125));
          }
        }(),
        ...);
    return error;
  }
};

/// e = a (Σ x_i over any number of vertices) − z.
class EdgeSum : public BaseEdge<EdgeSum, 3, Vector<double, 4>, AnyNumberOf<VertexOf<3>>> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 4>& m, std::span<const Vector<S, 3>> x) {
    Vector<S, 3> sum(-m[1], -m[2], -m[3]);
    for (std::size_t i = 0; i < x.size(); ++i) sum += Vector<S, 3>(m[0] * x[i]);
    return sum;
  }
};

/// Vertices "V1", "V2", "V3", "V6", "V9" and edges over them; the linear systems.
std::shared_ptr<Registry> mixedRegistry();

/// What a random graph is made of.
struct MixedShape {
  int vertices = 12;
  int edges = 40;
  /// Share of vertices that are fixed, and of those that are fixed in some directions.
  double fixed = 0.0;
  double held = 0.0;
  /// A unary edge on every vertex, so that H is positive definite.
  bool anchored = true;
};
Graph randomMixedGraph(const MixedShape& shape, std::mt19937& random);

/// H and g of a problem, dense and slow, one edge at a time.
struct DenseSystem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  explicit DenseSystem(const Problem& problem);
};

/// A random set of variables that no edge joins.
std::vector<char> randomIndependentSet(const Problem& problem, std::mt19937& random);

}  // namespace quiver::test
