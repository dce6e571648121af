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

/// Memory that the next node will fill. With every product, kernels fetch some lines of it to be written and move
/// `begin` on, so that clearing and loading it does not wait for what lies behind the second cache. Where threads share
/// a node it is empty, and then never written to.
struct UpcomingMemory {
  const double* begin;
  const double* end;
};

/// How the lower triangle of an update matrix lies in memory: strips of `width` columns one after the other, each with
/// the rows from its first diagonal entry down to `rows`. Both are multiples of 8. Blocks of a leaf subtree do not
/// cross the borders of strips; those of less than leastPanelDimension have a single strip.
struct UpdateLayout {
  std::int32_t rows;
  std::int32_t width;
};

/// The update matrix of a leaf subtree, and room for the largest of its panels.
struct LeafUpdate {
  double* values;
  UpdateLayout layout;
  double* panel;
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
  std::int16_t group;         // columns from this one on that do not wait for each other; 0 inside such a group
  std::int16_t inPanel;       // 1 if a LeafPanel takes its products outside the subtree
};

/// Consecutive columns of a leaf subtree whose blocks outside have the same rows. Copied side by side they are a panel,
/// whose product with itself is subtracted from the update matrix at once. Its runs of rows begin and end at multiples
/// of 8 of the update matrix and are filled up with zeros.
struct LeafPanel {
  std::int32_t first;  // column
  std::int32_t last;
  std::int32_t stride;  // rows of the panel
  std::int32_t runs;    // first entry in LeafView::panelRuns
  std::int32_t runCount;
};

/// A subtree whose block columns are stored one by one: blocks of dimension b as b columns of `leafStride(b)` doubles,
/// eight more behind the last.
struct LeafView {
  const LeafColumn* columns;
  std::int32_t count;
  /// Block rows outside, below all columns.
  std::int32_t outside;
  /// Each block row's place in a vector of the subtree: `count` + `outside` blocks of leafPlace(b) doubles, padded
  /// with zeros.
  const std::int32_t* rows;
  /// Row of each outside block in the update matrix.
  const std::int32_t* positions;
  /// For each inside block q of a column, and each block i ≥ q: the offset of the values from which L_i L_qᵀ is
  /// subtracted.
  const std::int32_t* destinations;
  /// By ascending columns; one more, behind all columns, closes the list.
  const LeafPanel* panels;
  /// `source` is the panel's row for the multiple of 8 at or before `destination`, which is a row of the update matrix.
  const RowRun* panelRuns;
};

constexpr int largestLeafDimension = 9;
/// Dimension of blocks from which on leaf subtrees have panels: with smaller ones, looking for them costs what they
/// save.
constexpr int leastPanelDimension = 4;
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
                      int rowBegin, int rowEnd, UpcomingMemory* upcoming);

  /// The first `columns` columns of U = −B Bᵀ on and below the diagonal; B has `rows` (padded) rows and `depth`
  /// columns.
  void (*formUpdate)(double* update, std::int64_t updateStride, const double* below, std::int64_t stride, int depth,
                     int columns, int rows, UpcomingMemory* upcoming);

  /// Adds the lower triangle of a child's update matrix to the columns [begin, end) of the parent's storage numbering;
  /// target points to the storage position (shift, shift).
  void (*addChild)(const double* child, UpdateLayout layout, const RowRun* runs, int count, double* target,
                   std::int64_t targetStride, int shift, int begin, int end);

  /// v ← panel's forward substitution: the first `columns` rows become y, the rows below get −L y added.
  void (*forward)(const double* panel, std::int64_t stride, int columns, int rows, const double* inverse, double* v);

  /// The first `columns` entries of v become the solution of Lᵀ x = y − (rows below)ᵀ v.
  void (*backward)(const double* panel, std::int64_t stride, int columns, int rows, const double* inverse, double* v);

  /// Leaf subtrees by block dimension 1 … 9 (entry 0 is null). Loading fills the values: blocks of H, zero elsewhere;
  /// `begin` has the first of `loads` of each column, and one more. Factorisation subtracts from the update matrix, and
  /// returns the column of the failed pivot times the dimension plus its coordinate, or −1.
  void (*leafLoad[largestLeafDimension + 1])(const LeafView& leaf, const LoadEntry* loads, const std::int64_t* begin,
                                             const double* source, double* values);
  int (*leafFactor[largestLeafDimension + 1])(const LeafView& leaf, double* values, double* inverse,
                                              const LeafUpdate& update, double* pivot, UpcomingMemory* upcoming);
  /// x are the subtree's scalars, v is a vector of the subtree. Forward, `update` receives what the rows outside get;
  /// backward, the places of the rows outside in v hold their solution.
  void (*leafForward[largestLeafDimension + 1])(const LeafView& leaf, const double* values, const double* inverse,
                                                double* x, double* v, double* update);
  void (*leafBackward[largestLeafDimension + 1])(const LeafView& leaf, const double* values, const double* inverse,
                                                 double* x, double* v);
};

/// Doubles that b numbers take in vectors: of a column of a leaf block in registers, or of a block row in a vector of
/// the subtree.
constexpr int leafPlace(int b) { return b <= 2 ? b : (b + 3) / 4 * 4; }
/// Doubles between the columns of a leaf block of dimension b. Blocks of dimension 5, 6 and 7 are stored without
/// padding: what is read behind a column belongs to the next one.
constexpr int leafStride(int b) { return b >= 5 && b <= 7 ? b : leafPlace(b); }

// Of internal linkage, so that no instruction set's version serves for others.
namespace {

/// Where a strip of an update matrix begins, and the distance of its columns.
constexpr std::int64_t stripBegin(UpdateLayout layout, std::int64_t strip) {
  return layout.width * (strip * layout.rows - layout.width * (strip * (strip - 1) / 2));
}
constexpr std::int64_t stripStride(UpdateLayout layout, std::int64_t strip) {
  return layout.rows - strip * layout.width;
}

}  // namespace

/// Null where the compiler or the target has no such instructions.
const KernelTable* genericKernels();
const KernelTable* avx2Kernels();
const KernelTable* avx512Kernels();

}  // namespace quiver::detail
