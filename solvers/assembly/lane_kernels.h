#pragma once

#include <utility>

#include <quiver/core/problem/lane_records.h>
#include <quiver/core/problem/panel.h>
#include <quiver/geometry/scalar/lanes.h>
#include <quiver/solvers/assembly/lane_products.h>

// The loops behind LaneProducts, for lanes of any instruction set. Everything is inlined into a function that carries
// the set. Included by lane_products.cpp alone.

namespace quiver::detail {

constexpr int width = Panel::lanes;

/// record[k] += Σ over lanes of in[k], k < Size, a multiple of eight.
template <int Size, typename L>
inline void addSums(const L* in, double* record) {
  for (int k = 0; k < Size; ++k) {
    double sum = in[k].v[0];
    for (int i = 1; i < width; ++i) sum += in[k].v[i];
    record[k] += sum;
  }
}

#if QUIVER_NATIVE_LANES
/// Eight sums at a time, by halving: 14 shuffles.
template <int Size>
QUIVER_TARGET_AVX512 inline void addSums(const Lanes<isa::Avx512>* in, double* record) {
  const Index8 even = {0, 8, 2, 10, 4, 12, 6, 14}, odd = {1, 9, 3, 11, 5, 13, 7, 15};
  const Index8 even2 = {0, 1, 8, 9, 4, 5, 12, 13}, odd2 = {2, 3, 10, 11, 6, 7, 14, 15};
  const Index8 low = {0, 1, 2, 3, 8, 9, 10, 11}, high = {4, 5, 6, 7, 12, 13, 14, 15};
  for (int k = 0; k < Size; k += width) {
    Native8 r[width];
    for (int i = 0; i < width; ++i) r[i] = *reinterpret_cast<const Native8*>(in[k + i].v);
    Native8 two[4];
    for (int i = 0; i < 4; ++i)
      two[i] = __builtin_shuffle(r[2 * i], r[2 * i + 1], even) + __builtin_shuffle(r[2 * i], r[2 * i + 1], odd);
    Native8 four[2];
    for (int i = 0; i < 2; ++i)
      four[i] =
          __builtin_shuffle(two[2 * i], two[2 * i + 1], even2) + __builtin_shuffle(two[2 * i], two[2 * i + 1], odd2);
    *reinterpret_cast<Native8*>(record + k) +=
        __builtin_shuffle(four[0], four[1], low) + __builtin_shuffle(four[0], four[1], high);
  }
}
#endif

/// Whether all eight edges add to one place: each would wait for the sum of the one before.
inline bool allAlike(double* const* out) {
  bool one = true;
  for (int i = 1; i < width; ++i) one = one && out[i] == out[0];
  return one;
}

/// Σ over k of x[k] y[k], columns of `rows` lane vectors.
template <typename L>
inline L dot(const double* x, const double* y, int rows) {
  L u;
  L v;
  loadLanes(x, u);
  loadLanes(y, v);
  L sum = u * v;
  for (int k = 1; k < rows; ++k) {
    loadLanes(x + k * width, u);
    loadLanes(y + k * width, v);
    sum += u * v;
  }
  return sum;
}

/// Entry At of JᵀJ and Jᵀr of eight edges; zero behind the last.
template <typename L, int N, int D, int At>
inline L squareEntry(const double* J, const double* residual) {
  constexpr TriangleEntry entry = triangleEntry<D>(At);
  if constexpr (entry.row == D) return L(0.0);
  const double* const x = J + entry.row * N * width;
  const double* const y = entry.column < D ? J + entry.column * N * width : residual;
  return dot<L>(x, y, N);
}

/// Sizes as constants: eight numbers of eight edges at a time stay in registers until they are turned into records.
template <typename L, int N, int D>
inline void squareFixed(const double* J, const double* residual, double* const* out) {
  constexpr int numbers = LaneProducts::paddedSize(D);
  const bool one = allAlike(out);
  const auto addEight = [&]<int First, int... I>(std::integral_constant<int, First>, std::integer_sequence<int, I...>) {
    const L part[width] = {squareEntry<L, N, D, First + I>(J, residual)...};
    if (one) {
      addSums<width>(part, out[0] + First);
      return;
    }
    double* records[width];
    for (int i = 0; i < width; ++i) records[i] = out[i] + First;
    addRecords<width>(part, records);
  };
  [&]<int... Chunk>(std::integer_sequence<int, Chunk...>) {
    (addEight(std::integral_constant<int, Chunk * width>(), std::make_integer_sequence<int, width>()), ...);
  }
  (std::make_integer_sequence<int, numbers / width>());
  if constexpr (numbers % width == 1) {
    const L last = squareEntry<L, N, D, numbers - 1>(J, residual);
    if (one) {
      out[0][numbers - 1] +=
          ((last.v[0] + last.v[1]) + (last.v[2] + last.v[3])) + ((last.v[4] + last.v[5]) + (last.v[6] + last.v[7]));
    } else {
      for (int i = 0; i < width; ++i) out[i][numbers - 1] += last.v[i];
    }
  }
}

/// Number `At` of AᵀB of eight edges, column by column or row by row; zero behind the last.
template <typename L, int N, int Da, int Db, bool transposed, int At>
inline L crossEntry(const double* A, const double* B) {
  if constexpr (At >= Da * Db) return L(0.0);
  constexpr int inner = transposed ? Db : Da;
  constexpr int a = transposed ? At / inner : At % inner;
  constexpr int b = transposed ? At % inner : At / inner;
  return dot<L>(A + a * N * width, B + b * N * width, N);
}

/// AᵀB of eight edges, eight numbers at a time: written, or added to blocks of a whole number of eights, as one sum if
/// `one` takes them all.
template <typename L, int N, int Da, int Db, bool transposed, bool add>
inline void crossOneWay(const double* A, const double* B, double* const* out, bool one) {
  const auto some = [&]<int First, int... I>(std::integral_constant<int, First>, std::integer_sequence<int, I...>) {
    const L part[sizeof...(I)] = {crossEntry<L, N, Da, Db, transposed, First + I>(A, B)...};
    double* records[width];
    for (int i = 0; i < width; ++i) records[i] = out[i] + First;
    if constexpr (!add) {
      storeRecords<static_cast<int>(sizeof...(I))>(part, records);
    } else if (one) {
      addSums<width>(part, records[0]);
    } else {
      addRecords<width>(part, records);
    }
  };
  constexpr int rest = Da * Db % width;
  constexpr int whole = (Da * Db + (add ? width - 1 : 0)) / width;
  [&]<int... Chunk>(std::integer_sequence<int, Chunk...>) {
    (some(std::integral_constant<int, Chunk * width>(), std::make_integer_sequence<int, width>()), ...);
  }
  (std::make_integer_sequence<int, whole>());
  if constexpr (!add && rest != 0)
    some(std::integral_constant<int, whole * width>(), std::make_integer_sequence<int, rest>());
}

/// AᵀB of eight edges, transposed in the lanes that ask for it.
template <typename L, int N, int Da, int Db, bool add>
inline void crossFixed(const double* A, const double* B, const std::int64_t* flip, double* const* out) {
  int flipped = 0;
  for (int i = 0; i < width; ++i) flipped += flip[i] != 0 ? 1 : 0;
  const bool one = add && allAlike(out);
  if (flipped == 0) return crossOneWay<L, N, Da, Db, false, add>(A, B, out, one);
  if (flipped == width) return crossOneWay<L, N, Da, Db, true, add>(A, B, out, one);
  alignas(64) double scrap[(Da * Db + width - 1) / width * width] = {};
  double* some[width];
  for (int i = 0; i < width; ++i) some[i] = flip[i] != 0 ? scrap : out[i];
  crossOneWay<L, N, Da, Db, false, add>(A, B, some, false);
  for (int i = 0; i < width; ++i) some[i] = flip[i] != 0 ? out[i] : scrap;
  crossOneWay<L, N, Da, Db, true, add>(A, B, some, false);
}

template <typename L>
inline void addLanes(const L& value, double* out) {
  L sum;
  loadLanes(out, sum);
  storeLanes(sum + value, out);
}

template <typename L>
inline void squareAny(const double* J, const double* residual, int rows, int columns, double* const* out) {
  int at = 0;
  for (int a = 0; a < columns; ++a) {
    for (int b = a; b < columns; ++b, ++at) {
      const L sum = dot<L>(J + a * rows * width, J + b * rows * width, rows);
      for (int i = 0; i < width; ++i) out[i][at] += sum.v[i];
    }
  }
  for (int a = 0; a < columns; ++a, ++at) {
    const L sum = dot<L>(J + a * rows * width, residual, rows);
    for (int i = 0; i < width; ++i) out[i][at] += sum.v[i];
  }
}

template <typename L, bool add>
inline void crossAny(const double* A, const double* B, int rows, int columnsA, int columnsB, const std::int64_t* flip,
                     double* const* out) {
  for (int b = 0; b < columnsB; ++b) {
    for (int a = 0; a < columnsA; ++a) {
      const L product = dot<L>(A + a * rows * width, B + b * rows * width, rows);
      for (int i = 0; i < width; ++i) {
        double& number = out[i][flip[i] != 0 ? a * columnsB + b : b * columnsA + a];
        number = add ? number + product.v[i] : product.v[i];
      }
    }
  }
}

template <typename L>
inline L weightOf(const double* weights) {
  L weight;
  loadLanes(weights, weight);
  return max(weight, L(0.0));
}

/// Rows [A, End) of w JᵀJ and their part of w Jᵀr, summed over all groups in registers.
template <typename L, int N, int D, int A, int End>
inline void sumRows(const double* J, const double* residual, const double* weights, int groups, double* sums) {
  constexpr int first = A * D - A * (A - 1) / 2;
  constexpr int count = End * D - End * (End - 1) / 2 - first;
  L products[count];
  L gradient[End - A];
  for (int k = 0; k < count; ++k) products[k] = L(0.0);
  for (int k = 0; k < End - A; ++k) gradient[k] = L(0.0);
  for (int g = 0; g < groups; ++g, J += N * D * width, residual += N * width, weights += width) {
    const L weight = weightOf<L>(weights);
    for (int r = 0; r < N; ++r) {
      L column[D - A];
      L error;
      for (int c = A; c < D; ++c) loadLanes(J + (c * N + r) * width, column[c - A]);
      loadLanes(residual + r * width, error);
      for (int a = A, at = 0; a < End; ++a) {
        const L weighed = weight * column[a - A];
        for (int b = a; b < D; ++b, ++at) products[at] += weighed * column[b - A];
        gradient[a - A] += weighed * error;
      }
    }
  }
  for (int k = 0; k < count; ++k) addLanes(products[k], sums + (first + k) * width);
  for (int k = 0; k < End - A; ++k) addLanes(gradient[k], sums + (D * (D + 1) / 2 + A + k) * width);
}

/// Sizes as constants, as many rows at a time as registers hold.
template <typename L, int N, int D>
inline void sumFixed(const double* J, const double* residual, const double* weights, int groups, double* sums) {
  constexpr int half = D <= 3 ? D : D / 2;
  sumRows<L, N, D, 0, half>(J, residual, weights, groups, sums);
  if constexpr (half < D) sumRows<L, N, D, half, D>(J, residual, weights, groups, sums);
}

template <typename L>
inline void sumAny(const double* J, const double* residual, const double* weights, int rows, int columns, int groups,
                   double* sums) {
  for (int g = 0; g < groups; ++g, J += rows * columns * width, residual += rows * width, weights += width) {
    const L weight = weightOf<L>(weights);
    int at = 0;
    for (int a = 0; a < columns; ++a) {
      for (int b = a; b < columns; ++b, ++at)
        addLanes(weight * dot<L>(J + a * rows * width, J + b * rows * width, rows), sums + at * width);
    }
    for (int a = 0; a < columns; ++a, ++at)
      addLanes(weight * dot<L>(J + a * rows * width, residual, rows), sums + at * width);
  }
}

}  // namespace quiver::detail
