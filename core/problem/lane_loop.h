#pragma once

#include <cstdint>
#include <tuple>
#include <utility>

#include <quiver/core/problem/batch_view.h>
#include <quiver/core/problem/edge_functions.h>
#include <quiver/core/problem/lane_records.h>
#include <quiver/core/problem/panel.h>
#include <quiver/geometry/scalar/dual.h>

namespace quiver::detail {

/// Numbers a type occupies in the constants of an edge.
template <typename M>
constexpr int packedSize() {
  if constexpr (Packable<M>) {
    return Packing<M>::size;
  } else {
    return 0;
  }
}

/// Everything about an edge type that the loops need at compile time, with the roles' types spread into packs.
template <typename E, typename Vertices = typename E::VertexTypes, typename Parameters = typename E::Parameters>
struct EdgeLoop;

template <typename E, typename... V, typename... P>
struct EdgeLoop<E, std::tuple<V...>, ParameterList<P...>> {
  using Functions = EdgeFunctions<E>;
  using M = typename E::Measurement;
  static constexpr int rows = E::errorDimension;
  static constexpr int arity = sizeof...(V);
  static constexpr int triangle = rows * (rows + 1) / 2;
  static constexpr int measurementSize = packedSize<M>();
  static constexpr int parameterSize = (0 + ... + Packing<typename P::Value>::size);
  static constexpr int values = measurementSize + parameterSize;
  static constexpr int constants = values + triangle;
  static constexpr int columns[] = {V::dimension...};
  static constexpr int tangent = (0 + ... + V::dimension);
  template <typename S>
  using Estimates = std::tuple<typename Functions::template ValueOf<typename V::Estimate, S>...>;
  template <typename S>
  using ParameterValues = std::tuple<typename Functions::template ValueOf<typename P::Value, S>...>;
  template <typename S>
  using Blocks = std::tuple<Matrix<S, rows, V::dimension>...>;

  template <int Role>
  static constexpr int columnOffset() {
    int offset = 0;
    for (int i = 0; i < Role; ++i) offset += columns[i];
    return offset;
  }
  template <int Index>
  static constexpr int parameterOffset() {
    constexpr int sizes[] = {Packing<typename P::Value>::size..., 0};
    int offset = measurementSize;
    for (int i = 0; i < Index; ++i) offset += sizes[i];
    return offset;
  }

  /// Parameter values from an edge's constants.
  template <typename S>
  static ParameterValues<S> parameterValues(const S* constant) {
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return ParameterValues<S>(Packing<typename P::Value>::template load<S>(constant + parameterOffset<I>())...);
    }
    (std::make_integer_sequence<int, static_cast<int>(sizeof...(P))>());
  }

  /// Moves estimates by tangent vectors whose gradients are the unit vectors: dual numbers that carry all directions.
  template <typename S>
  static Estimates<Dual<S, tangent>> seeded(const Estimates<S>& x) {
    using D = Dual<S, tangent>;
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return Estimates<D>([&] {
        using Vertex = std::tuple_element_t<static_cast<std::size_t>(I), std::tuple<V...>>;
        Vector<D, Vertex::dimension> delta;
        for (int c = 0; c < Vertex::dimension; ++c) {
          delta[c] = D(S(0.0));
          delta[c].gradient[columnOffset<I>() + c] = S(1.0);
        }
        return Vertex::oplus(lifted<D, typename Vertex::Estimate>(std::get<I>(x)), delta);
      }()...);
    }
    (std::make_integer_sequence<int, arity>());
  }

  /// A value as constants of a dual number type.
  template <typename D, typename T, typename Value>
  static typename Packing<T>::template Rebind<D> lifted(const Value& value) {
    using S = std::remove_cvref_t<decltype(std::declval<D>().value)>;
    S numbers[Packing<T>::size];
    Packing<T>::store(value, numbers);
    D duals[Packing<T>::size];
    for (int i = 0; i < Packing<T>::size; ++i) duals[i] = D(numbers[i]);
    return Packing<T>::template load<D>(duals);
  }

  /// Error and blocks by dual numbers.
  template <typename S, typename Measurement>
  static Vector<S, rows> linearizeDual(const E& edge, const Measurement& m, const ParameterValues<S>& p,
                                       const Estimates<S>& x, Blocks<S>& J) {
    using D = Dual<S, tangent>;
    const Estimates<D> moved = seeded<S>(x);
    const Vector<D, rows> error = [&]<int... I>(std::integer_sequence<int, I...>) {
      return callError<D>(edge, liftedMeasurement<D>(m),
                          ParameterValues<D>(lifted<D, typename P::Value>(std::get<I>(p))...), moved);
    }
    (std::make_integer_sequence<int, static_cast<int>(sizeof...(P))>());
    Vector<S, rows> value;
    for (int r = 0; r < rows; ++r) value[r] = error[r].value;
    [&]<int... I>(std::integer_sequence<int, I...>) { (copyGradients<columnOffset<I>()>(error, std::get<I>(J)), ...); }
    (std::make_integer_sequence<int, arity>());
    return value;
  }

  template <typename D, typename Measurement>
  static auto liftedMeasurement(const Measurement& m) {
    if constexpr (Packable<M>) {
      return lifted<D, M>(m);
    } else {
      return m;
    }
  }

  template <int Offset, typename Error, typename Block>
  static void copyGradients(const Error& error, Block& J) {
    for (int c = 0; c < Block::ColsAtCompileTime; ++c) {
      for (int r = 0; r < rows; ++r) J(r, c) = error[r].gradient[Offset + c];
    }
  }

  /// computeError, static or of the edge at hand.
  template <typename S, typename Measurement>
  static Vector<S, rows> callError(const E& edge, const Measurement& m, const ParameterValues<S>& p,
                                   const Estimates<S>& x) {
    return [&]<int... A, int... B>(std::integer_sequence<int, A...>, std::integer_sequence<int, B...>) {
      if constexpr (Functions::template staticError<S>) {
        return E::computeError(m, std::get<A>(p)..., std::get<B>(x)...);
      } else {
        return edge.computeError(m, std::get<A>(p)..., std::get<B>(x)...);
      }
    }
    (std::make_integer_sequence<int, static_cast<int>(sizeof...(P))>(), std::make_integer_sequence<int, arity>());
  }

  template <typename S, typename Measurement>
  static void callJacobian(const E& edge, const Measurement& m, const ParameterValues<S>& p, const Estimates<S>& x,
                           Blocks<S>& J) {
    [&]<int... A, int... B>(std::integer_sequence<int, A...>, std::integer_sequence<int, B...>) {
      if constexpr (Functions::template staticJacobian<S>) {
        E::linearizeOplus(m, std::get<A>(p)..., std::get<B>(x)..., std::get<B>(J)...);
      } else {
        edge.linearizeOplus(m, std::get<A>(p)..., std::get<B>(x)..., std::get<B>(J)...);
      }
    }
    (std::make_integer_sequence<int, static_cast<int>(sizeof...(P))>(), std::make_integer_sequence<int, arity>());
  }
};

/// column ← U column, U upper triangular, row by row, or its diagonal alone. In place: row r needs rows ≥ r only.
template <int Rows, typename S, typename Column>
inline void whiten(const S* U, bool diagonal, Column&& column) {
  if (diagonal) {
    for (int r = 0; r < Rows; ++r) column(r) = U[r] * column(r);
    return;
  }
  for (int r = 0, k = 0; r < Rows; k += Rows - r, ++r) {
    S sum = U[k] * column(r);
    for (int c = r + 1; c < Rows; ++c) sum += U[k + c - r] * column(c);
    column(r) = sum;
  }
}

/// Whitens a block column by column and writes it in lanes.
template <int Rows, int Columns, typename L, typename Block>
inline void storeBlock(const L* U, bool diagonal, Block& J, double* out, int group) {
  for (int c = 0; c < Columns; ++c) {
    whiten<Rows>(U, diagonal, J.col(c));
    for (int r = 0; r < Rows; ++r) storeLanes(J(r, c), out + ((group * Columns + c) * Rows + r) * L::width);
  }
}

/// The first Size numbers of eight records of a state; recordOf(i) is where the i-th begins.
template <int Size, typename L, typename RecordOf>
inline void loadStates(const double* state, const RecordOf& recordOf, L* numbers) {
  std::int64_t differs = 0;
  for (int i = 1; i < L::width; ++i) differs |= std::int64_t{recordOf(i)} ^ std::int64_t{recordOf(0)};
  if (differs == 0) {  // all eight join the same vertex, as the observations of one camera do
    for (int k = 0; k < Size; ++k) numbers[k] = L(state[recordOf(0) + k]);
    return;
  }
  const double* pointers[L::width];
  for (int i = 0; i < L::width; ++i) pointers[i] = state + recordOf(i);
  loadRecords<Size>(pointers, numbers);
}

/// The estimates of eight edges, role by role: of the `group`-th row if there are rows, else of the ids, which follow
/// each other in a `run`.
template <typename E, typename L>
inline typename EdgeLoop<E>::template Estimates<L> loadEstimates(const BatchView& view, const std::int32_t* ids,
                                                                 bool run, int group) {
  using Loop = EdgeLoop<E>;
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return typename Loop::template Estimates<L>([&] {
      using Vertex = std::tuple_element_t<static_cast<std::size_t>(I), typename E::VertexTypes>;
      constexpr int size = Packing<typename Vertex::Estimate>::size;
      L numbers[size];
      if (view.rows != nullptr) {
        const std::uint32_t* const records = view.rows + (std::int64_t{group} * Loop::arity + I) * L::width;
        loadStates<size>(
            view.state, [=](int i) { return records[i]; }, numbers);
      } else if (run) {
        const std::int64_t* const records = view.records + I * view.edges + ids[0];
        loadStates<size>(
            view.state, [=](int i) { return records[i]; }, numbers);
      } else {
        const std::int64_t* const records = view.records + I * view.edges;
        loadStates<size>(
            view.state, [=](int i) { return records[ids[i]]; }, numbers);
      }
      return Packing<typename Vertex::Estimate>::template load<L>(numbers);
    }()...);
  }
  (std::make_integer_sequence<int, Loop::arity>());
}

/// Eight edges at a time: loads, calls the type's functions with S = Lanes, whitens, writes the panel. Everything is
/// inlined into the caller, which carries the instruction set.
template <typename E, typename L, bool analytic, bool withJacobians>
inline void laneLoop(const BatchView& view, const std::int32_t* edges, int count, const Panel& panel) {
  using Loop = EdgeLoop<E>;
  constexpr int rows = Loop::rows;
  for (int begin = 0; begin < count; begin += L::width) {
    const int group = begin / L::width;
    std::int32_t ids[L::width] = {};
    L scattered[Loop::constants];
    const bool inRows = view.rows != nullptr;
    const L* constant = scattered;
    bool run = false;
    if (inRows) {
      constant = asLanes<L>(view.constants + std::int64_t{begin} * view.numbers);
    } else {
      for (int i = 0; i < L::width; ++i) ids[i] = edges[begin + i < count ? begin + i : count - 1];
      const int present = count - begin < L::width ? count - begin : L::width;
      const bool inLanes = isRun(ids, present);
      run = inLanes && present == L::width;
      if (inLanes) {
        constant = asLanes<L>(view.constants + std::int64_t{ids[0]} * view.numbers);
      } else if (view.diagonal) {
        gatherConstants<Loop::values + rows>(view.constants, view.numbers, ids, scattered);
      } else {
        gatherConstants<Loop::constants>(view.constants, view.numbers, ids, scattered);
      }
    }
    const L* const U = constant + Loop::values;  // its diagonal alone, or the upper triangle
    const auto m = Packing<typename E::Measurement>::template load<L>(constant);
    const auto p = Loop::template parameterValues<L>(constant);
    const auto x = loadEstimates<E, L>(view, ids, run, group);
    const E& none = *static_cast<const E*>(view.objects[ids[0]]);
    Vector<L, rows> error;
    if constexpr (withJacobians) {
      typename Loop::template Blocks<L> J;
      if constexpr (analytic) {
        error = Loop::template callError<L>(none, m, p, x);
        Loop::template callJacobian<L>(none, m, p, x, J);
      } else {
        error = Loop::template linearizeDual<L>(none, m, p, x, J);
      }
      [&]<int... I>(std::integer_sequence<int, I...>) {
        (storeBlock<rows, Loop::columns[I]>(U, view.diagonal, std::get<I>(J), panel.jacobian[I], group), ...);
      }
      (std::make_integer_sequence<int, Loop::arity>());
    } else {
      error = Loop::template callError<L>(none, m, p, x);
    }
    whiten<rows>(U, view.diagonal, error);
    L square = error(0) * error(0);
    for (int r = 1; r < rows; ++r) square += error(r) * error(r);
    for (int r = 0; r < rows; ++r) storeLanes(error(r), panel.residual + (group * rows + r) * L::width);
    storeLanes(square, panel.squaredError + group * L::width);
  }
}

}  // namespace quiver::detail
