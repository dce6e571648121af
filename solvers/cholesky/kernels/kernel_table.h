#pragma once

#include <cstdint>

// Included by translation units compiled for newer instruction sets than the rest of the library: plain types only, no
// inline functions and no library headers, so that nothing compiled there can be picked by the linker for everybody.

namespace quiver::detail {

/// Consecutive rows of a child's update matrix that are consecutive in its parent's front.
struct RowRun {
  std::int32_t source;       // first row in the child's update matrix
  std::int32_t length;       // rows
  std::int32_t destination;  // first row in the parent's storage: columns first, padded, then the rows below
};

/// Where one block of H goes: `rows` × `columns` doubles from `source` in BlockMatrix::values() to `destination` in the
/// node's values.
struct LoadEntry {
  std::int64_t source;
  std::int32_t destination;
  std::int16_t rows;
  std::int16_t columns;
};

/// One block column of a leaf subtree. Offsets of values count from the subtree's first value.
struct LeafColumn {
  std::int32_t values;        // the diagonal block; the blocks below follow
  std::int32_t scalar;        // first scalar, counted from the subtree's first
  std::int32_t below;         // blocks below the diagonal
  std::int32_t inside;        // how many of them have their row in the subtree; these come first
  std::int32_t rows;          // first entry of the blocks below in LeafView::rows and ::positions
  std::int32_t destinations;  // first entry in LeafView::destinations
  std::int32_t group;         // columns from this one on that do not wait for each other; 0 inside such a group
};

/// A subtree whose block columns are stored one by one: blocks of dimension b as b columns of `leafStride(b)` doubles.
struct LeafView {
  const LeafColumn* columns;
  std::int32_t count;
  /// Block rows outside, below all columns.
  std::int32_t outside;
  /// Each block row's place in a vector of the subtree: `count` + `outside` blocks of leafStride(b) doubles, padded
  /// with zeros.
  const std::int32_t* rows;
  /// Row of each outside block in the update matrix.
  const std::int32_t* positions;
  /// For each inside block q of a column, and each block i ≥ q: the offset of the values from which L_i L_qᵀ is
  /// subtracted.
  const std::int32_t* destinations;
};

constexpr int largestLeafDimension = 9;
/// Columns factored together in a front.
constexpr int chunkColumns = 48;

/// The numeric kernels, compiled once for each instruction set. All matrices are column-major; leading dimensions and
/// row bounds are multiples of 8. The panel of a front has its columns' rows first, padded with zeros to a multiple of
/// 8, then the rows below.
struct KernelTable {
  const char* name;

  /// Factors the lower triangle of the `width` ≤ 48 columns at `begin` and their rows; stores the reciprocals of L's
  /// diagonal. Returns the first column (counted from `begin`) whose pivot is not positive and finite, its pivot in
  /// *pivot, or −1.
  int (*factorDiagonal)(double* panel, std::int64_t stride, int begin, int width, double* inverse, double* pivot);

  /// Finishes rows [rowBegin, rowEnd) below a factored diagonal: L = A L_dᵀ⁻¹.
  void (*solveRows)(double* panel, std::int64_t stride, int begin, int width, int rowBegin, int rowEnd,
                    const double* inverse);

  /// Subtracts the product of the chunk's columns from panel columns [columnBegin, columnEnd), rows [rowBegin, rowEnd)
  /// on or below the diagonal.
  void (*updatePanel)(double* panel, std::int64_t stride, int begin, int width, int columnBegin, int columnEnd,
                      int rowBegin, int rowEnd);

  /// Columns [columnBegin, columnEnd) of U = −B Bᵀ on and below the diagonal; B has `rows` (padded) rows and `depth`
  /// columns.
  void (*formUpdate)(double* update, std::int64_t updateStride, const double* below, std::int64_t stride, int depth,
                     int columnBegin, int columnEnd, int rows);

  /// Adds the lower triangle of a child's update matrix to the columns [begin, end) of the parent's storage numbering;
  /// target points to the storage position (shift, shift).
  void (*addChild)(const double* child, std::int64_t childStride, const RowRun* runs, int count, double* target,
                   std::int64_t targetStride, int shift, int begin, int end);

  /// v ← panel's forward substitution: the first `columns` rows become y, the rows below get −L y added.
  void (*forward)(const double* panel, std::int64_t stride, int columns, int rows, const double* inverse, double* v);

  /// The first `columns` entries of v become the solution of Lᵀ x = y − (rows below)ᵀ v.
  void (*backward)(const double* panel, std::int64_t stride, int columns, int rows, const double* inverse, double* v);

  /// Leaf subtrees by block dimension 1 … 9 (entry 0 is null). Loading fills the values: blocks of H, zero elsewhere;
  /// `begin` has the first of `loads` of each column, and one more. Factorisation returns the column of the failed
  /// pivot times the dimension plus its coordinate, or −1.
  void (*leafLoad[largestLeafDimension + 1])(const LeafView& leaf, const LoadEntry* loads, const std::int64_t* begin,
                                             const double* source, double* values);
  int (*leafFactor[largestLeafDimension + 1])(const LeafView& leaf, double* values, double* inverse, double* update,
                                              std::int64_t updateStride, double* pivot);
  /// x are the subtree's scalars, v is a vector of the subtree. Forward, `update` receives what the rows outside get;
  /// backward, the places of the rows outside in v hold their solution.
  void (*leafForward[largestLeafDimension + 1])(const LeafView& leaf, const double* values, const double* inverse,
                                                double* x, double* v, double* update);
  void (*leafBackward[largestLeafDimension + 1])(const LeafView& leaf, const double* values, const double* inverse,
                                                 double* x, double* v);
};

/// Doubles between the columns of a leaf block of dimension b.
constexpr int leafStride(int b) { return b <= 2 ? b : (b + 3) / 4 * 4; }

/// Null where the compiler or the target has no such instructions.
const KernelTable* genericKernels();
const KernelTable* avx2Kernels();
const KernelTable* avx512Kernels();

}  // namespace quiver::detail
