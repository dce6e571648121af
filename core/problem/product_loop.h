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

/// The upper triangle of JᵀJ, row by row, then Jᵀr, added to eight records: eight numbers at a time, which stay in
/// registers until they are turned.
template <typename L, typename Block, typename Error>
inline void addSquare(const Block& J, const Error& error, double* const* records) {
  constexpr int D = Block::ColsAtCompileTime;
  constexpr int numbers = recordNumbers(D);
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
  const auto addEight = [&]<int First, int... I>(std::integral_constant<int, First>, std::integer_sequence<int, I...>) {
    const L part[L::width] = {entry(std::integral_constant<int, First + I>())...};
    double* out[L::width];
    for (int i = 0; i < L::width; ++i) out[i] = records[i] + First;
    addRecords<L::width>(part, out);
  };
  [&]<int... Chunk>(std::integer_sequence<int, Chunk...>) {
    (addEight(std::integral_constant<int, Chunk * L::width>(), std::make_integer_sequence<int, L::width>()), ...);
  }
  (std::make_integer_sequence<int, numbers / L::width>());
  if constexpr (numbers % L::width == 1) {
    const L last = entry(std::integral_constant<int, numbers - 1>());
    for (int i = 0; i < L::width; ++i) records[i][numbers - 1] += last.v[i];
  }
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
  L placed[Da * Db];
  [&]<int... K>(std::integer_sequence<int, K...>) {
    ((placed[K] = select(flipped, result[K % Db * Da + K / Db], result[K])), ...);
  }
  (std::make_integer_sequence<int, Da * Db>());
  storeRecords<Da * Db>(placed, blocks);
}

/// Brings the lines of the next group's blocks on their way while this group is computed.
inline void prefetchBlocks(double* const* blocks, int numbers) {
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < numbers; k += 8) __builtin_prefetch(blocks[i] + k, 1);
  }
}

/// Edges first … first + count − 1, `first` a multiple of eight: errors, blocks and their products, in registers.
/// squaredError[i] is eᵀΩe of edge first + i, for whole groups of eight.
template <typename E, typename L, bool analytic>
inline void productLoop(const BatchView& view, int first, int count, const ProductTargets& targets,
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
    const L* const U = constant + values;
    whitenBlocks<rows>(U, view.whitening, J);
    whiten<rows>(U, view.whitening, error);
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

/// Whether products are worth a loop of their own for an edge type: one or two roles, and blocks that fit the first
/// cache in lanes.
template <typename E>
constexpr bool multipliesInLoop() {
  using Loop = EdgeLoop<E>;
  return Loop::arity <= 2 && Loop::rows * Loop::tangent <= 96;
}

}  // namespace quiver::detail
