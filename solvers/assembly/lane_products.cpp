#include <quiver/solvers/assembly/lane_products.h>

#include <quiver/solvers/assembly/lane_kernels.h>

namespace quiver {
namespace {

/// The kernels of one instruction set. ATTRIBUTE makes each a batch loop of the set.
#define QUIVER_LANE_PRODUCTS(NAME, ISA, ATTRIBUTE)                                                                  \
  struct NAME {                                                                                                     \
    using L = Lanes<ISA>;                                                                                           \
    template <int N, int D>                                                                                         \
    ATTRIBUTE static void square(const double* J, const double* residual, int, int, double* const* out) {           \
      detail::squareFixed<L, N, D>(J, residual, out);                                                               \
    }                                                                                                               \
    template <int N, int Da, int Db, bool add>                                                                      \
    ATTRIBUTE static void cross(const double* A, const double* B, int, int, int, const std::int64_t* flip,          \
                                double* const* out) {                                                               \
      detail::crossFixed<L, N, Da, Db, add>(A, B, flip, out);                                                       \
    }                                                                                                               \
    ATTRIBUTE static void squareLoop(const double* J, const double* residual, int rows, int columns,                \
                                     double* const* out) {                                                          \
      detail::squareAny<L>(J, residual, rows, columns, out);                                                        \
    }                                                                                                               \
    template <bool add>                                                                                             \
    ATTRIBUTE static void crossLoop(const double* A, const double* B, int rows, int columnsA, int columnsB,         \
                                    const std::int64_t* flip, double* const* out) {                                 \
      detail::crossAny<L, add>(A, B, rows, columnsA, columnsB, flip, out);                                          \
    }                                                                                                               \
    template <int N, int D>                                                                                         \
    ATTRIBUTE static void sum(const double* J, const double* residual, const double* weights, int, int, int groups, \
                              double* sums) {                                                                       \
      detail::sumFixed<L, N, D>(J, residual, weights, groups, sums);                                                \
    }                                                                                                               \
    ATTRIBUTE static void sumLoop(const double* J, const double* residual, const double* weights, int rows,         \
                                  int columns, int groups, double* sums) {                                          \
      detail::sumAny<L>(J, residual, weights, rows, columns, groups, sums);                                         \
    }                                                                                                               \
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

template <typename Set, bool add>
LaneProducts::Cross pickCross(int rows, int columnsA, int columnsB) {
  const int size = rows * 10000 + columnsA * 100 + columnsB;
  switch (size) {
    case 10302:
      return Set::template cross<1, 3, 2, add>;
    case 20302:
      return Set::template cross<2, 3, 2, add>;
    case 20604:
      return Set::template cross<2, 6, 4, add>;
    case 20608:
      return Set::template cross<2, 6, 8, add>;
    case 20609:
      return Set::template cross<2, 6, 9, add>;
    case 30303:
      return Set::template cross<3, 3, 3, add>;
    case 30603:
      return Set::template cross<3, 6, 3, add>;
    case 60606:
      return Set::template cross<6, 6, 6, add>;
    default:
      return Set::template crossLoop<add>;
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

template <bool add>
LaneProducts::Cross pickCrossOf(InstructionSet set, int rows, int columnsA, int columnsB) {
  if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
    if (set == InstructionSet::avx512) return pickCross<Avx512Products, add>(rows, columnsA, columnsB);
  }
  if (set != InstructionSet::generic) return pickCross<Avx2Products, add>(rows, columnsA, columnsB);
  return pickCross<GenericProducts, add>(rows, columnsA, columnsB);
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
  return pickCrossOf<false>(set, rows, columnsA, columnsB);
}

LaneProducts::Cross LaneProducts::addedCross(InstructionSet set, int rows, int columnsA, int columnsB) {
  return pickCrossOf<true>(set, rows, columnsA, columnsB);
}

LaneProducts::Sum LaneProducts::sum(InstructionSet set, int rows, int columns) {
  if constexpr (QUIVER_EVERY_INSTRUCTION_SET) {
    if (set == InstructionSet::avx512) return pickSum<Avx512Products>(rows, columns);
  }
  if (set != InstructionSet::generic) return pickSum<Avx2Products>(rows, columns);
  return pickSum<GenericProducts>(rows, columns);
}

}  // namespace quiver
