#pragma once

#include <algorithm>
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

  template <typename Block>
  static void clear(Block& J) {
    [&]<int... K>(std::integer_sequence<int, K...>) { ((J(K % rows, K / rows) = typename Block::Scalar(0.0)), ...); }
    (std::make_integer_sequence<int, Block::SizeAtCompileTime>());
  }

  template <typename S, typename Measurement>
  static void callJacobian(const E& edge, const Measurement& m, const ParameterValues<S>& p, const Estimates<S>& x,
                           Blocks<S>& J) {
    [&]<int... A, int... B>(std::integer_sequence<int, A...>, std::integer_sequence<int, B...>) {
      // Functions write what is not zero. Entry by entry, so that the compiler drops what they overwrite.
      (clear(std::get<B>(J)), ...);
      if constexpr (Functions::template staticJacobian<S>) {
        E::linearizeOplus(m, std::get<A>(p)..., std::get<B>(x)..., std::get<B>(J)...);
      } else {
        edge.linearizeOplus(m, std::get<A>(p)..., std::get<B>(x)..., std::get<B>(J)...);
      }
    }
    (std::make_integer_sequence<int, static_cast<int>(sizeof...(P))>(), std::make_integer_sequence<int, arity>());
  }
};

/// Whitens the blocks of all roles.
template <int Rows, typename L, typename Blocks>
inline void whitenBlocks(const L* U, Whitening whitening, Blocks& J) {
  if (whitening == Whitening::diagonal) {
    std::apply([&](auto&... block) { (whitenBlock<Rows, Whitening::diagonal>(U, block), ...); }, J);
  } else if (whitening == Whitening::triangular) {
    std::apply([&](auto&... block) { (whitenBlock<Rows, Whitening::triangular>(U, block), ...); }, J);
  }
}

/// Writes a block of eight edges in lanes, column by column.
template <typename L, typename Block>
inline void storeBlock(const Block& J, double* out) {
  constexpr int rows = Block::RowsAtCompileTime;
  for (int c = 0; c < Block::ColsAtCompileTime; ++c) {
    for (int r = 0; r < rows; ++r) storeLanes(J(r, c), out + (c * rows + r) * L::width);
  }
}

/// The first Size numbers of eight records of a state; recordOf(i) is where the i-th begins.
template <int Size, typename L, typename RecordOf>
inline void loadStates(const double* state, const RecordOf& recordOf, L* numbers) {
  const auto first = recordOf(0);
  bool same = recordOf(L::width - 1) == first;  // mostly tells already
  for (int i = 1; same && i < L::width - 1; ++i) same = recordOf(i) == first;
  if (same) {  // all eight join the same vertex, as the observations of one camera do
    for (int k = 0; k < Size; ++k) numbers[k] = L(state[first + k]);
    return;
  }
  const double* pointers[L::width];
  for (int i = 0; i < L::width; ++i) pointers[i] = state + recordOf(i);
  loadRecords<Size>(pointers, numbers);
}

/// The estimates of eight edges, role by role: of the `group`-th row if there are rows, else of the ids, of which the
/// first tells if they follow each other in a `run`.
template <typename E, typename L>
inline typename EdgeLoop<E>::template Estimates<L> loadEstimates(const BatchView& view, const std::int32_t* ids,
                                                                 bool run, std::int64_t group) {
  using Loop = EdgeLoop<E>;
  return [&]<int... I>(std::integer_sequence<int, I...>) {
    return typename Loop::template Estimates<L>([&] {
      using Vertex = std::tuple_element_t<static_cast<std::size_t>(I), typename E::VertexTypes>;
      constexpr int size = Packing<typename Vertex::Estimate>::size;
      L numbers[size];
      if (view.rows != nullptr) {
        const std::uint32_t* const records = view.rows + (group * Loop::arity + I) * L::width;
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

/// A measurement from the constants of eight edges: long ones where they lie.
template <typename M, typename L>
inline decltype(auto) measurementOf(const L* constant) {
  if constexpr (Packing<M>::size > 4 && requires { Packing<M>::template view<L>(constant); }) {
    return Packing<M>::template view<L>(constant);
  } else {
    return Packing<M>::template load<L>(constant);
  }
}

/// The constants of a group of eight edges, which begins at `begin` of the list: where they lie if they lie in lanes,
/// else gathered into `scattered`. `run`: the edges of the list follow each other.
template <typename Loop, typename L>
inline const L* groupConstants(const BatchView& view, const std::int32_t* ids, int begin, bool run, L* scattered) {
  if (view.rows != nullptr) return asLanes<L>(view.constants + std::int64_t{begin} * view.numbers);
  if (run) return asLanes<L>(view.constants + std::int64_t{ids[0]} * view.numbers);
  if (view.whitening == Whitening::none) {
    gatherConstants<Loop::values>(view.constants, view.numbers, ids, scattered);
  } else if (view.whitening == Whitening::diagonal) {
    gatherConstants<Loop::values + Loop::rows>(view.constants, view.numbers, ids, scattered);
  } else {
    gatherConstants<Loop::constants>(view.constants, view.numbers, ids, scattered);
  }
  return scattered;
}

/// Eight edges at a time: loads, calls the type's functions with S = Lanes, whitens, writes the panel. Everything is
/// inlined into the caller, which carries the instruction set.
template <typename E, typename L, bool analytic, bool withJacobians>
inline void laneLoop(const BatchView& batch, const std::int32_t* edges, int count, const Panel& panel) {
  using Loop = EdgeLoop<E>;
  constexpr int rows = Loop::rows;
  // Copies: what is written to the panel cannot change them, so they stay in registers.
  const BatchView view = batch;
  const Panel to = panel;
  double* blocks[Loop::arity] = {};
  if constexpr (withJacobians) std::copy_n(to.jacobian, Loop::arity, blocks);
  const bool run = view.rows == nullptr && isRun(edges, count);
  for (int begin = 0; begin < count; begin += L::width) {
    const std::int64_t group = begin / L::width;
    const bool whole = begin + L::width <= count;
    std::int32_t ids[L::width] = {};
    if (run && whole) {
      ids[0] = edges[begin];
    } else if (view.rows == nullptr) {
      for (int i = 0; i < L::width; ++i) ids[i] = edges[begin + i < count ? begin + i : count - 1];
    }
    L scattered[Loop::constants];
    const L* const constant = groupConstants<Loop>(view, ids, begin, run, scattered);
    const L* const U = constant + Loop::values;
    decltype(auto) m = measurementOf<typename E::Measurement>(constant);
    const auto p = Loop::template parameterValues<L>(constant);
    const auto x = loadEstimates<E, L>(view, ids, run && whole, group);
    const E& any = *static_cast<const E*>(view.objects[0]);  // functions that take lanes are static
    Vector<L, rows> error;
    if constexpr (withJacobians) {
      typename Loop::template Blocks<L> J;
      if constexpr (analytic) {
        error = Loop::template callError<L>(any, m, p, x);
        Loop::template callJacobian<L>(any, m, p, x, J);
      } else {
        error = Loop::template linearizeDual<L>(any, m, p, x, J);
      }
      whitenBlocks<rows>(U, view.whitening, J);
      [&]<int... I>(std::integer_sequence<int, I...>) {
        (storeBlock<L>(std::get<I>(J), blocks[I] + group * (rows * Loop::columns[I] * L::width)), ...);
      }
      (std::make_integer_sequence<int, Loop::arity>());
    } else {
      error = Loop::template callError<L>(any, m, p, x);
    }
    whiten<rows>(U, view.whitening, error);
    L square = error(0) * error(0);
    for (int r = 1; r < rows; ++r) square += error(r) * error(r);
    for (int r = 0; r < rows; ++r) storeLanes(error(r), to.residual + (group * rows + r) * L::width);
    storeLanes(square, to.squaredError + group * L::width);
  }
}

}  // namespace quiver::detail
