#include <quiver/solvers/assembly/lane_products.h>

#include <quiver/core/problem/lane_records.h>
#include <quiver/geometry/scalar/lanes.h>

namespace quiver {
namespace {

using detail::addRecords;
using detail::loadLanes;
using detail::storeLanes;
using detail::storeRecords;

constexpr int width = 8;

/// Sizes as constants: every product stays in registers until a chunk of eight numbers is turned into records.
template <typename L, int N, int D>
inline void squareFixed(const double* J, const double* residual, double* const* out) {
  constexpr int triangle = D * (D + 1) / 2;
  constexpr int padded = LaneProducts::paddedSize(D);
  L result[padded];
  L r[N];
  for (int k = 0; k < N; ++k) loadLanes(residual + k * width, r[k]);
  L column[N * D];
  for (int k = 0; k < N * D; ++k) loadLanes(J + k * width, column[k]);
  for (int a = 0, at = 0; a < D; ++a) {
    for (int b = a; b < D; ++b, ++at) {
      L sum = column[a * N] * column[b * N];
      for (int k = 1; k < N; ++k) sum += column[a * N + k] * column[b * N + k];
      result[at] = sum;
    }
    L sum = column[a * N] * r[0];
    for (int k = 1; k < N; ++k) sum += column[a * N + k] * r[k];
    result[triangle + a] = sum;
  }
  for (int k = triangle + D; k < padded; ++k) result[k] = L(0.0);
  addRecords<padded>(result, out);
}

template <typename L, int N, int Da, int Db>
inline void crossFixed(const double* A, const double* B, const std::int64_t* flip, double* const* out) {
  L result[Da * Db];
  L a[N * Da];
  for (int k = 0; k < N * Da; ++k) loadLanes(A + k * width, a[k]);
  for (int j = 0; j < Db; ++j) {
    L b[N];
    for (int k = 0; k < N; ++k) loadLanes(B + (j * N + k) * width, b[k]);
    for (int i = 0; i < Da; ++i) {
      L sum = a[i * N] * b[0];
      for (int k = 1; k < N; ++k) sum += a[i * N + k] * b[k];
      result[j * Da + i] = sum;
    }
  }
  typename L::Mask flipped;
  for (int i = 0; i < width; ++i) flipped.v[i] = flip[i];
  L placed[Da * Db];
  for (int k = 0; k < Da * Db; ++k) placed[k] = select(flipped, result[k % Db * Da + k / Db], result[k]);
  storeRecords<Da * Db>(placed, out);
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

template <typename L>
inline void crossAny(const double* A, const double* B, int rows, int columnsA, int columnsB, const std::int64_t* flip,
                     double* const* out) {
  for (int b = 0; b < columnsB; ++b) {
    for (int a = 0; a < columnsA; ++a) {
      const L sum = dot<L>(A + a * rows * width, B + b * rows * width, rows);
      for (int i = 0; i < width; ++i) out[i][flip[i] != 0 ? a * columnsB + b : b * columnsA + a] = sum.v[i];
    }
  }
}

/// Rows [A, End) of JᵀJ and their part of Jᵀr, summed over all groups in registers.
template <typename L, int N, int D, int A, int End>
inline void sumRows(const double* J, const double* residual, int groups, double* sums) {
  constexpr int first = A * D - A * (A - 1) / 2;
  constexpr int count = End * D - End * (End - 1) / 2 - first;
  L products[count];
  L gradient[End - A];
  for (int k = 0; k < count; ++k) products[k] = L(0.0);
  for (int k = 0; k < End - A; ++k) gradient[k] = L(0.0);
  for (int g = 0; g < groups; ++g, J += N * D * width, residual += N * width) {
    for (int r = 0; r < N; ++r) {
      L column[D - A];
      L error;
      for (int c = A; c < D; ++c) loadLanes(J + (c * N + r) * width, column[c - A]);
      loadLanes(residual + r * width, error);
      for (int a = A, at = 0; a < End; ++a) {
        for (int b = a; b < D; ++b, ++at) products[at] += column[a - A] * column[b - A];
        gradient[a - A] += column[a - A] * error;
      }
    }
  }
  for (int k = 0; k < count; ++k) addLanes(products[k], sums + (first + k) * width);
  for (int k = 0; k < End - A; ++k) addLanes(gradient[k], sums + (D * (D + 1) / 2 + A + k) * width);
}

/// Sizes as constants, as many rows at a time as registers hold.
template <typename L, int N, int D>
inline void sumFixed(const double* J, const double* residual, int groups, double* sums) {
  constexpr int half = D <= 3 ? D : D / 2;
  sumRows<L, N, D, 0, half>(J, residual, groups, sums);
  if constexpr (half < D) sumRows<L, N, D, half, D>(J, residual, groups, sums);
}

template <typename L>
inline void sumAny(const double* J, const double* residual, int rows, int columns, int groups, double* sums) {
  for (int g = 0; g < groups; ++g, J += rows * columns * width, residual += rows * width) {
    int at = 0;
    for (int a = 0; a < columns; ++a) {
      for (int b = a; b < columns; ++b, ++at)
        addLanes(dot<L>(J + a * rows * width, J + b * rows * width, rows), sums + at * width);
    }
    for (int a = 0; a < columns; ++a, ++at) addLanes(dot<L>(J + a * rows * width, residual, rows), sums + at * width);
  }
}

/// The kernels of one instruction set. ATTRIBUTE makes each a batch loop of the set.
#define QUIVER_LANE_PRODUCTS(NAME, ISA, ATTRIBUTE)                                                            \
  struct NAME {                                                                                               \
    using L = Lanes<ISA>;                                                                                     \
    template <int N, int D>                                                                                   \
    ATTRIBUTE static void square(const double* J, const double* residual, int, int, double* const* out) {     \
      squareFixed<L, N, D>(J, residual, out);                                                                 \
    }                                                                                                         \
    template <int N, int Da, int Db>                                                                          \
    ATTRIBUTE static void cross(const double* A, const double* B, int, int, int, const std::int64_t* flip,    \
                                double* const* out) {                                                         \
      crossFixed<L, N, Da, Db>(A, B, flip, out);                                                              \
    }                                                                                                         \
    ATTRIBUTE static void squareLoop(const double* J, const double* residual, int rows, int columns,          \
                                     double* const* out) {                                                    \
      squareAny<L>(J, residual, rows, columns, out);                                                          \
    }                                                                                                         \
    ATTRIBUTE static void crossLoop(const double* A, const double* B, int rows, int columnsA, int columnsB,   \
                                    const std::int64_t* flip, double* const* out) {                           \
      crossAny<L>(A, B, rows, columnsA, columnsB, flip, out);                                                 \
    }                                                                                                         \
    template <int N, int D>                                                                                   \
    ATTRIBUTE static void sum(const double* J, const double* residual, int, int, int groups, double* sums) {  \
      sumFixed<L, N, D>(J, residual, groups, sums);                                                           \
    }                                                                                                         \
    ATTRIBUTE static void sumLoop(const double* J, const double* residual, int rows, int columns, int groups, \
                                  double* sums) {                                                             \
      sumAny<L>(J, residual, rows, columns, groups, sums);                                                    \
    }                                                                                                         \
  };
QUIVER_LANE_PRODUCTS(Avx512Products, isa::Avx512, QUIVER_BATCH_LOOP_AVX512)
QUIVER_LANE_PRODUCTS(Avx2Products, isa::Avx2, QUIVER_BATCH_LOOP_AVX2)
QUIVER_LANE_PRODUCTS(GenericProducts, isa::Generic, QUIVER_BATCH_LOOP_GENERIC)
#undef QUIVER_LANE_PRODUCTS

/// Adding a size to the fast ones is one line in each function.
template <typename Set>
LaneProducts::Square pickSquare(int rows, int columns) {
  const int size = rows * 100 + columns;
  switch (size) {
    case 102:
      return Set::template square<1, 2>;
    case 103:
      return Set::template square<1, 3>;
    case 106:
      return Set::template square<1, 6>;
    case 202:
      return Set::template square<2, 2>;
    case 203:
      return Set::template square<2, 3>;
    case 204:
      return Set::template square<2, 4>;
    case 206:
      return Set::template square<2, 6>;
    case 208:
      return Set::template square<2, 8>;
    case 209:
      return Set::template square<2, 9>;
    case 303:
      return Set::template square<3, 3>;
    case 306:
      return Set::template square<3, 6>;
    case 606:
      return Set::template square<6, 6>;
    default:
      return Set::squareLoop;
  }
}

template <typename Set>
LaneProducts::Cross pickCross(int rows, int columnsA, int columnsB) {
  const int size = rows * 10000 + columnsA * 100 + columnsB;
  switch (size) {
    case 10302:
      return Set::template cross<1, 3, 2>;
    case 20302:
      return Set::template cross<2, 3, 2>;
    case 20604:
      return Set::template cross<2, 6, 4>;
    case 20608:
      return Set::template cross<2, 6, 8>;
    case 20609:
      return Set::template cross<2, 6, 9>;
    case 30303:
      return Set::template cross<3, 3, 3>;
    case 30603:
      return Set::template cross<3, 6, 3>;
    case 60606:
      return Set::template cross<6, 6, 6>;
    default:
      return Set::crossLoop;
  }
}

template <typename Set>
LaneProducts::Sum pickSum(int rows, int columns) {
  const int size = rows * 100 + columns;
  switch (size) {
    case 106:
      return Set::template sum<1, 6>;
    case 203:
      return Set::template sum<2, 3>;
    case 206:
      return Set::template sum<2, 6>;
    case 303:
      return Set::template sum<3, 3>;
    case 306:
      return Set::template sum<3, 6>;
    case 606:
      return Set::template sum<6, 6>;
    default:
      return Set::sumLoop;
  }
}

}  // namespace

LaneProducts::Square LaneProducts::square(InstructionSet set, int rows, int columns) {
  if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
    if (set == InstructionSet::avx512) return pickSquare<Avx512Products>(rows, columns);
  }
  if (set != InstructionSet::generic) return pickSquare<Avx2Products>(rows, columns);
  return pickSquare<GenericProducts>(rows, columns);
}

LaneProducts::Cross LaneProducts::cross(InstructionSet set, int rows, int columnsA, int columnsB) {
  if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
    if (set == InstructionSet::avx512) return pickCross<Avx512Products>(rows, columnsA, columnsB);
  }
  if (set != InstructionSet::generic) return pickCross<Avx2Products>(rows, columnsA, columnsB);
  return pickCross<GenericProducts>(rows, columnsA, columnsB);
}

LaneProducts::Sum LaneProducts::sum(InstructionSet set, int rows, int columns) {
  if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
    if (set == InstructionSet::avx512) return pickSum<Avx512Products>(rows, columns);
  }
  if (set != InstructionSet::generic) return pickSum<Avx2Products>(rows, columns);
  return pickSum<GenericProducts>(rows, columns);
}

}  // namespace quiver
