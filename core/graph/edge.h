#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include <quiver/core/graph/change_flag.h>
#include <quiver/core/graph/edge_id_list.h>
#include <quiver/core/graph/parameter.h>
#include <quiver/core/graph/robust_kernel.h>
#include <quiver/core/graph/vertex.h>

namespace quiver {

/// What all edges have in common: the vertices they join, a level, a robust kernel. Knows nothing of any solver.
///
/// Assigning one edge to another copies what it says (measurement, information, level, kernel) and not where it
/// belongs: vertices, parameters and graph remain those of the edge assigned to.
class Edge {
 public:
  Edge() = default;
  Edge(const Edge&) = default;
  Edge& operator=(const Edge& other) {
    level_ = other.level_;
    kernel_ = other.kernel_;
    countChange();
    return *this;
  }

  /// Ids of the vertices, in the order of the edge type's roles.
  std::span<const std::int64_t> vertexIds() const { return ids_.vertices(); }
  std::int64_t vertexId(int role) const { return ids_.vertex(role); }
  int arity() const { return ids_.vertexCount(); }
  std::span<const std::int64_t> parameterIds() const { return ids_.parameters(); }

  /// Replaces eᵀΩe by ρ(eᵀΩe) in the cost; `RobustKernel()` removes it.
  void setRobustKernel(const RobustKernel& kernel) {
    kernel_ = kernel;
    countChange();
  }
  const RobustKernel& robustKernel() const { return kernel_; }

  /// Edges of one level are optimised together; 0 unless set.
  void setLevel(int level) {
    level_ = level;
    change_.raise();
  }
  int level() const { return level_; }

  /// Index of its type in the registry of its graph.
  int type() const { return type_; }

  /// Another number after every change of the measurement, the information or the kernel, and for every edge that was
  /// at this address of this graph: what was compiled from the edge is good as long as the number is the same.
  std::uint64_t changes() const { return changes_; }

 protected:
  void countChange() {
    ++changes_;
    change_.raise();
  }

 private:
  friend class Graph;
  EdgeIdList ids_;
  ChangeLink change_;
  std::uint64_t changes_ = 0;
  std::int32_t level_ = 0;
  std::int32_t slot_ = -1;
  std::uint16_t type_ = 0;
  bool alive_ = false;
  RobustKernel kernel_;
};

/// The last of an edge's vertex types: any number (≥ 1) of vertices of that type. `computeError` takes `std::span<const
/// Estimate<S>>`.
template <typename VertexType>
struct AnyNumberOf {};

/// How an edge's Jacobians are made.
enum class Jacobians { automatic, analytic, dual, numeric };

/// Throws GraphError unless the matrix (column-major) is an information matrix: square, finite, symmetric (to 1e-9 of
/// its largest entry), no eigenvalue below −1e-6 of the largest. O(rows³).
void checkInformation(const double* matrix, int rows, int columns);

namespace detail {

/// Keeps a measurement: packable ones as unaligned doubles, others as they are.
template <typename M>
class MeasurementStore {
 public:
  M get() const { return value_; }
  void set(const M& value) { value_ = value; }

 private:
  M value_{};
};

template <Packable M>
class MeasurementStore<M> {
 public:
  M get() const { return Packing<M>::template load<double>(values_.data()); }
  void set(const M& value) { Packing<M>::store(value, values_.data()); }
  const double* values() const { return values_.data(); }

 private:
  std::array<double, static_cast<std::size_t>(Packing<M>::size)> values_ = defaultNumbers<M>();
};

/// Keeps the upper triangle of a symmetric matrix, row by row.
template <int N>
class TriangleStore {
 public:
  static constexpr int entries = N * (N + 1) / 2;
  TriangleStore() noexcept {
    for (int r = 0, k = 0; r < N; k += N - r, ++r) values_[static_cast<std::size_t>(k)] = 1.0;
  }
  int dimension() const { return N; }
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }
  void resize(int) {}

 private:
  std::array<double, static_cast<std::size_t>(entries)> values_{};
};

template <>
class TriangleStore<Dynamic> {
 public:
  int dimension() const { return dimension_; }
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }
  /// Identity of the given dimension.
  void resize(int dimension) {
    dimension_ = dimension;
    values_.assign(static_cast<std::size_t>(dimension) * static_cast<std::size_t>(dimension + 1) / 2, 0.0);
    for (int r = 0, k = 0; r < dimension; k += dimension - r, ++r) values_[static_cast<std::size_t>(k)] = 1.0;
  }

 private:
  std::vector<double> values_;
  int dimension_ = 0;
};

/// Whether a matrix is finite, symmetric to the last bit, and each diagonal entry at least the sum of the magnitudes
/// beside it: then no eigenvalue is negative (Gershgorin). Nearly every information matrix is found good by this.
template <typename M>
bool isPlainlyDominant(const M& matrix) {
  if (matrix.rows() != matrix.cols()) return false;
  for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
    double beside = 0.0;
    for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
      if (r == c) continue;
      if (matrix(r, c) != matrix(c, r)) return false;
      beside += std::abs(matrix(r, c));
    }
    if (!(matrix(c, c) >= beside) || !std::isfinite(matrix(c, c))) return false;
  }
  return true;
}

template <typename M>
void requireInformation(const M& matrix) {
  if (!isPlainlyDominant(matrix))
    checkInformation(matrix.data(), static_cast<int>(matrix.rows()), static_cast<int>(matrix.cols()));
}

}  // namespace detail

/// An edge is a pure function from a measurement and estimates to an error.
///
/// `Derived` supplies `template <typename S> static Vector<S, N> computeError(const M<S>& measurement, [const P<S>&
/// parameter…,] const X<S>& estimate…)`. `N` is the error's dimension, `M` the measurement's type, `Vertices…` the
/// vertex types. See `core/problem/edge_functions.h` for the forms that are found by concept: analytic Jacobians,
/// lanes, member functions. `N` may be Dynamic, and the last of the vertices `AnyNumberOf<V>`.
template <typename Derived, int N, typename M, typename... Vertices>
class BaseEdge : public Edge {
 public:
  using Measurement = M;
  using VertexTypes = std::tuple<Vertices...>;
  using Parameters = ParameterList<>;
  static constexpr int errorDimension = N;
  /// Whether `Edge`, derived from this, has no members of its own: all it has is initialised here.
  template <typename Edge>
  static constexpr bool addsNothing() {
    return N != Dynamic && sizeof(Edge) == sizeof(BaseEdge);
  }

  M measurement() const { return measurement_.get(); }
  void setMeasurement(const M& measurement) {
    measurement_.set(measurement);
    countChange();
  }

  /// Ω, symmetric positive semi-definite, dimension × dimension, in the order of the error vector. Always checked when
  /// set through the graph.
  Matrix<double, N, N> information() const {
    const int n = information_.dimension();
    Matrix<double, N, N> result(n, n);
    const std::span<const double> values = information_.values();
    std::size_t k = 0;
    for (int r = 0; r < n; ++r) {
      for (int c = r; c < n; ++c) result(r, c) = result(c, r) = values[k++];
    }
    return result;
  }
  /// Throws GraphError if the matrix is not square, not finite, not symmetric, or has an eigenvalue below −1e-6 of the
  /// largest.
  void setInformation(const Matrix<double, N, N>& information) {
    detail::requireInformation(information);
    const int n = static_cast<int>(information.rows());
    countChange();
    information_.resize(n);
    std::size_t k = 0;
    for (int r = 0; r < n; ++r) {
      for (int c = r; c < n; ++c) information_.values()[k++] = information(r, c);
    }
  }

  const detail::MeasurementStore<M>& measurementStore() const { return measurement_; }
  /// To be written at once: later changes through the reference go unnoticed.
  detail::TriangleStore<N>& informationStore() {
    countChange();
    return information_;
  }
  const detail::TriangleStore<N>& informationStore() const { return information_; }

 private:
  detail::MeasurementStore<M> measurement_;
  detail::TriangleStore<N> information_;
};

}  // namespace quiver
