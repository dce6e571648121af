// The kernels of elimination for one instruction set. A translation unit defines QUIVER_KERNEL_WIDTH (doubles a vector)
// and QUIVER_KERNEL_NAME, is compiled with that set's flags, and includes this file once: everything below is local to
// it.

#include <quiver/solvers/elimination/kernels/kernel_table.h>

namespace quiver::detail {
namespace {

#include <quiver/solvers/cholesky/kernels/kernel_vector.h>
//
#include <quiver/solvers/elimination/kernels/kernel_eight.h>
//
#include <quiver/solvers/elimination/kernels/kernel_rows.h>
//
#include <quiver/solvers/elimination/kernels/kernel_pairs.h>

AddPoint pickAddPoint(int N, int e) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (N == n && e == d) return addPoint<n, d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return addPoint<0, 0>;
}

FactorPoint pickFactorPoint(int e) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (e == d) return factorPoint<d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return factorPoint<0>;
}

SolvePoint pickSolvePoint(int e) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (e == d) return solvePoint<d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return solvePoint<0>;
}

ReduceRow pickReduceRow(int N, int K, int e) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (N == n && K == k && e == d) return reduceRow<n, k, d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return reduceRow<0, 0, 0>;
}

MultiplyRow pickMultiplyRow(int N, int K) {
#define QUIVER_ROW_SIZE(n, k, d)                  \
  if (N == n && K == k) return multiplyRow<n, k>; \
  if (N == n && K == d) return multiplyRow<n, d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return multiplyRow<0, 0>;
}

TransposedRow pickTransposedRow(int N, int e) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (N == n && e == d) return transposedRow<n, d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return transposedRow<0, 0>;
}

ScatterRow pickScatterRow(int N, int K) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (N == n && K == k) return scatterRow<n, k>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return scatterRow<0, 0>;
}

SubtractPairs pickSubtractPairs(int kRow, int kColumn, int e) {
#define QUIVER_PAIR_SIZE(r, c, d) \
  if (kRow == r && kColumn == c && e == d) return subtractPairs<r, c, d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_PAIR_SIZE
  return subtractPairsLoop;
}

SubtractSquares pickSubtractSquares(int K, int e) {
#define QUIVER_ROW_SIZE(n, k, d) \
  if (K == k && e == d) return subtractSquares<k, d>;
#include <quiver/solvers/elimination/kernels/kernel_sizes.h>
#undef QUIVER_ROW_SIZE
  return subtractSquaresLoop;
}

constexpr EliminationKernels kernels{QUIVER_KERNEL_NAME, pickAddPoint,       pickFactorPoint,   pickSolvePoint,
                                     pickReduceRow,      pickMultiplyRow,    pickTransposedRow, pickScatterRow,
                                     pickSubtractPairs,  pickSubtractSquares};

}  // namespace
}  // namespace quiver::detail
