#pragma once

#include <cstdint>
#include <tuple>
#include <utility>

#include <quiver/core/problem/lane_loop.h>
#include <quiver/core/problem/product_targets.h>

namespace quiver::detail {

// Products of Jacobian blocks of eight edges, in the loop that computes the blocks. Every index is a compile-time
// constant from the start, so the compiler sees which entries are structural zeros (below the rotation, above the
// translation) and drops what they would be multiplied with.

/// Σ over rows of column A of X times column B of Y.
template <int A, int B, typename X, typename Y>
inline auto columnProduct(const X& x, const Y& y) {
  return [&]<int... R>(std::integer_sequence<int, 0, R...>) {
    auto sum = x(0, A) * y(0, B);
    ((sum += x(R, A) * y(R, B)), ...);
    return sum;
  }
  (std::make_integer_sequence<int, X::RowsAtCompileTime>());
}

/// Calls part(first, 0 … its length − 1) for `numbers` in parts of eight, what is left in one part of length `last`.
template <int numbers, int last, typename Part>
inline void forEachPart(const Part& part) {
  [&]<int... Eight>(std::integer_sequence<int, Eight...>) {
    (part(std::integral_constant<int, Eight * 8>(), std::make_integer_sequence<int, 8>()), ...);
  }
  (std::make_integer_sequence<int, numbers / 8>());
  if constexpr (last > 0) part(std::integral_constant<int, numbers / 8 * 8>(), std::make_integer_sequence<int, last>());
}

/// The upper triangle of JᵀJ, row by row, then Jᵀr, added to eight records: eight numbers at a time, which stay in
/// registers until they are turned.
template <typename L, typename Block, typename Error>
inline void addSquare(const Block& J, const Error& error, double* const* records) {
  constexpr int D = Block::ColsAtCompileTime;
  constexpr int numbers = D * (D + 1) / 2 + D;
  const auto entry = [&]<int At>(std::integral_constant<int, At>) {
    constexpr TriangleEntry place = triangleEntry<D>(At);
    if constexpr (place.row == D) {
      return L(0.0);
    } else if constexpr (place.column == D) {
      return columnProduct<place.row, 0>(J, error);
    } else {
      return columnProduct<place.row, place.column>(J, J);
    }
  };
  constexpr int left = numbers % 8;
  constexpr int last = left <= 1 ? left : left <= 4 ? 4 : 8;
  forEachPart<numbers, last>([&]<int At, int... I>(std::integral_constant<int, At>, std::integer_sequence<int, I...>) {
    const L part[] = {entry(std::integral_constant<int, At + I>())...};
    double* out[L::width];
    for (int i = 0; i < L::width; ++i) out[i] = records[i] + At;
    addRecords<sizeof...(I)>(part, out);
  });
}

/// AᵀB column by column, transposed in the lanes that ask for it, written to eight blocks.
template <typename L, typename First, typename Second>
inline void writeCross(const First& a, const Second& b, const std::int64_t* flip, double* const* blocks) {
  constexpr int Da = First::ColsAtCompileTime;
  constexpr int Db = Second::ColsAtCompileTime;
  L result[Da * Db];
  [&]<int... K>(std::integer_sequence<int, K...>) { ((result[K] = columnProduct<K % Da, K / Da>(a, b)), ...); }
  (std::make_integer_sequence<int, Da * Db>());
  typename L::Mask flipped;
  for (int i = 0; i < L::width; ++i) flipped.v[i] = flip[i];
  constexpr int numbers = Da * Db;
  forEachPart<numbers, numbers % 8>([&]<int At, int... I>(std::integral_constant<int, At>,
                                                          std::integer_sequence<int, I...>) {
    const L part[] = {select(flipped, result[(At + I) % Db * Da + (At + I) / Db], result[At + I])...};
    double* out[L::width];
    for (int i = 0; i < L::width; ++i) out[i] = blocks[i] + At;
    storeRecords<sizeof...(I)>(part, out);
  });
}

/// Brings the lines of the next group's blocks on their way while this group is computed.
inline void prefetchBlocks(double* const* blocks, int numbers) {
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < numbers; k += 8) __builtin_prefetch(blocks[i] + k, 1);
  }
}

/// column C ← U column C.
template <bool triangular, int C, typename L, typename Block>
inline void whitenColumn(const L* U, Block& J) {
  constexpr int rows = Block::RowsAtCompileTime;
  [&]<int... R>(std::integer_sequence<int, R...>) {
    const auto row = [&]<int Row>(std::integral_constant<int, Row>) {
      if constexpr (triangular) {
        constexpr int diagonal = Row * rows - Row * (Row - 1) / 2;
        L sum = U[diagonal] * J(Row, C);
        [&]<int... K>(std::integer_sequence<int, K...>) { ((sum += U[diagonal + 1 + K] * J(Row + 1 + K, C)), ...); }
        (std::make_integer_sequence<int, rows - 1 - Row>());
        J(Row, C) = sum;
      } else {
        J(Row, C) = U[Row] * J(Row, C);
      }
    };
    (row(std::integral_constant<int, R>()), ...);
  }
  (std::make_integer_sequence<int, rows>());
}

/// J ← U J.
template <bool triangular, typename L, typename Block>
inline void whitenProduct(const L* U, Block& J) {
  [&]<int... C>(std::integer_sequence<int, C...>) { (whitenColumn<triangular, C>(U, J), ...); }
  (std::make_integer_sequence<int, Block::ColsAtCompileTime>());
}

/// Edges first … first + count − 1, `first` a multiple of eight: errors, blocks and their products, in registers.
/// squaredError[i] is eᵀΩe of edge first + i, for whole groups of eight. `triangular`: the whitening of the batch.
template <typename E, typename L, bool analytic, bool triangular>
inline void productLoopOf(const BatchView& view, int first, int count, const ProductTargets& targets,
                          double* squaredError) {
  using Loop = EdgeLoop<E>;
  constexpr int rows = Loop::rows;
  constexpr int values = Loop::values;
  for (int begin = 0; begin < count; begin += L::width) {
    const int at = first + begin;
    std::int32_t ids[L::width];
    for (int i = 0; i < L::width; ++i) ids[i] = at + i < view.edges ? at + i : static_cast<int>(view.edges) - 1;
    const double* in = view.constants + std::int64_t{at} * view.numbers;
    const L* const constant = asLanes<L>(in);
    decltype(auto) m = measurementOf<typename E::Measurement>(constant);
    const auto p = Loop::template parameterValues<L>(constant);
    const auto x = loadEstimates<E, L>(view, ids, at + L::width <= view.edges, 0);
    const E& none = *static_cast<const E*>(view.objects[at]);
    typename Loop::template Blocks<L> J;
    Vector<L, rows> error;
    if constexpr (analytic) {
      error = Loop::template callError<L>(none, m, p, x);
      Loop::template callJacobian<L>(none, m, p, x, J);
    } else {
      error = Loop::template linearizeDual<L>(none, m, p, x, J);
    }
    if constexpr (Loop::arity == 2) {
      if (begin + L::width < count)
        prefetchBlocks(targets.blocks[0] + at + L::width, Loop::columns[0] * Loop::columns[1]);
    }
    L ones[rows];
    for (int r = 0; r < rows; ++r) ones[r] = L(1.0);
    const L* const U = view.whitening == Whitening::none ? ones : constant + values;
    std::apply([&](auto&... block) { (whitenProduct<triangular>(U, block), ...); }, J);
    whitenProduct<triangular>(U, error);
    L square = error(0) * error(0);
    for (int r = 1; r < rows; ++r) square += error(r) * error(r);
    storeLanes(square, squaredError + begin);
    addSquare<L>(std::get<0>(J), error, targets.records[0] + at);
    if constexpr (Loop::arity == 2) {
      addSquare<L>(std::get<1>(J), error, targets.records[1] + at);
      writeCross<L>(std::get<0>(J), std::get<1>(J), targets.flipped[0] + at, targets.blocks[0] + at);
    }
  }
}

/// The loop of the batch's whitening: apart, so that the compiler sees which blocks stay zero.
template <typename E, typename L, bool analytic>
inline void productLoop(const BatchView& view, int first, int count, const ProductTargets& targets,
                        double* squaredError) {
  if (view.whitening == Whitening::triangular) {
    productLoopOf<E, L, analytic, true>(view, first, count, targets, squaredError);
  } else {
    productLoopOf<E, L, analytic, false>(view, first, count, targets, squaredError);
  }
}

/// Whether products are worth a loop of their own for an edge type: one or two roles, and blocks that fit the first
/// cache in lanes.
template <typename E>
constexpr bool multipliesInLoop() {
  using Loop = EdgeLoop<E>;
  return Loop::arity <= 2 && Loop::rows * Loop::tangent <= 128;
}

}  // namespace quiver::detail
