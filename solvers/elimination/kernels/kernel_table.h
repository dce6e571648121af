#pragma once

#include <cstdint>

// Included by translation units compiled for newer instruction sets than the rest of the library: plain types only, no
// inline functions and no library headers, so that nothing compiled there can be picked by the linker for everybody.

namespace quiver::detail {

// Notation. A row is eight edges, one for each of eight eliminated vertices: lane i belongs to vertex i. N is the
// dimension of the error, e that of the eliminated vertex, k that of a kept vertex of the edge. Numbers of a row lie in
// lanes: number m of lane i is at [8 m + i]; Jacobian blocks are column-major.
//
// Sums of an eliminated vertex, in lanes: the upper triangle of V = Σ JᵀJ row by row, then g = Σ Jᵀr.
// Its factor, in lanes: L with V + D = L Lᵀ column by column, the diagonal replaced by reciprocals (0 for a direction
// that is left out), then τ = L⁻¹ g.
//
// The record of an incidence, a pair of an eliminated and a kept vertex: Z = W L⁻ᵀ with W = Σ JₖᵀJₑ over their common
// edges, and τ as one more row of Z: `recordBody(k)` rows column by column, then `recordTail(k)` rows row by row.

/// Numbers of an eliminated vertex's sums, and of its factor.
constexpr int pointNumbers(int e) { return e * (e + 1) / 2 + e; }

/// Rows of a record that lie in whole vectors: of 2, 4, 8, 16, … doubles.
constexpr int recordBody(int k) {
  const int rows = k + 1;
  if (rows <= 2) return 2;
  if (rows <= 4) return 4;
  if (rows <= 8) return 8;
  return rows % 8 > 2 ? (rows / 8 + 1) * 8 : rows / 8 * 8;
}
/// Rows behind them: at most two.
constexpr int recordTail(int k) { return k + 1 > recordBody(k) ? k + 1 - recordBody(k) : 0; }
/// Doubles of a record, a multiple of 8.
constexpr int recordSize(int k, int e) { return (e * (recordBody(k) + recordTail(k)) + 7) / 8 * 8; }
/// Where entry (row, column) of a record lies; row k is τ.
constexpr int recordEntry(int k, int e, int row, int column) {
  return row < recordBody(k) ? column * recordBody(k) + row : e * recordBody(k) + (row - recordBody(k)) * e + column;
}

/// Places of two records in a tile's memory, in units of 8 doubles.
struct RecordPair {
  std::uint16_t row;
  std::uint16_t column;
};

/// Adds JᵀJ and Jᵀr to the sums.
using AddPoint = void (*)(const double* J, const double* residual, int N, int e, double* sums);
/// Factors V + diag(damping). A pivot that is not above `floor` times its diagonal leaves its direction out;
/// dropped[lane] counts them.
using FactorPoint = void (*)(const double* sums, const double* damping, int e, double floor, double* factor,
                             double* dropped);
/// t ← (L Lᵀ)⁻¹ t.
using SolvePoint = void (*)(const double* factor, int e, double* t);
/// Writes Z = JₖᵀJₑ L⁻ᵀ and τ to the lanes' records, or adds Z to them; `scratch` holds 8 N e doubles.
using ReduceRow = void (*)(const double* Jk, const double* Je, const double* factor, int N, int k, int e, bool add,
                           double* scratch, double* const* records);
/// u += J x with the lanes' vectors x; vectors may be read up to the next multiple of 8.
using MultiplyRow = void (*)(const double* J, const double* const* x, int N, int k, double* u);
/// t += Jᵀ u in lanes.
using TransposedRow = void (*)(const double* J, const double* u, int N, int e, double* t);
/// y += Jᵀ u to the lanes' vectors, in the order of lanes; vectors are padded to a multiple of 8.
using ScatterRow = void (*)(const double* J, const double* u, int N, int k, double* const* y);
/// Subtracts Σ Z_row Z_columnᵀ over pairs of records in `tile` from a column-major kRow × kColumn block.
using SubtractPairs = void (*)(const double* tile, const RecordPair* pairs, std::int64_t count, int kRow, int kColumn,
                               int e, double* block);
/// The same for pairs of a record with itself, and subtracts Σ Z τ from `right`.
using SubtractSquares = void (*)(const double* tile, const RecordPair* pairs, std::int64_t count, int k, int e,
                                 double* block, double* right);

/// The kernels of one instruction set. Sizes of `kernel_sizes.h` are compiled as constants, others run in loops.
struct EliminationKernels {
  const char* name;
  AddPoint (*addPoint)(int N, int e);
  FactorPoint (*factorPoint)(int e);
  SolvePoint (*solvePoint)(int e);
  ReduceRow (*reduceRow)(int N, int k, int e);
  MultiplyRow (*multiplyRow)(int N, int k);
  TransposedRow (*transposedRow)(int N, int e);
  ScatterRow (*scatterRow)(int N, int k);
  SubtractPairs (*subtractPairs)(int kRow, int kColumn, int e);
  SubtractSquares (*subtractSquares)(int k, int e);
};

/// Null where the compiler or the target has no such instructions.
const EliminationKernels* genericEliminationKernels();
const EliminationKernels* avx2EliminationKernels();
const EliminationKernels* avx512EliminationKernels();

}  // namespace quiver::detail
