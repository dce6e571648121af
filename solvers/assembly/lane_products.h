#pragma once

#include <cstdint>

#include <quiver/core/problem/product_targets.h>
#include <quiver/geometry/scalar/isa.h>

namespace quiver {

/// Products of Jacobian blocks that lie in lanes, for one group of eight edges; `rows` is the error's dimension. Sizes
/// met often are compiled as constants, others run in loops; either way eight edges at once in the machine's best
/// instruction set.
///
/// A block is `rows` × `columns`, column-major in lanes (Panel's layout, at the group's first number).
class LaneProducts {
 public:
  /// Adds for every edge i the upper triangle of JᵀJ, row by row, then Jᵀr, to out[i], which has paddedSize(columns)
  /// numbers. Several edges may share one: they are added edge after edge, or, if all eight do, as one sum.
  using Square = void (*)(const double* J, const double* residual, int rows, int columns, double* const* out);
  /// Writes for every edge i the columnsA × columnsB block AᵀB, or its transpose where flip[i] is −1 and not 0,
  /// column-major to out[i].
  using Cross = void (*)(const double* A, const double* B, int rows, int columnsA, int columnsB,
                         const std::int64_t* flip, double* const* out);

  /// Adds over all groups, in lanes, the upper triangle of w JᵀJ, row by row, then w Jᵀr: number k of lane i to
  /// sums[k · 8 + i]. The blocks of the groups follow each other; w is 0 where a weight is negative.
  using Sum = void (*)(const double* J, const double* residual, const double* weights, int rows, int columns,
                       int groups, double* sums);

  /// Kernels for a size on an instruction set that the machine has.
  static Square square(InstructionSet set, int rows, int columns);
  static Cross cross(InstructionSet set, int rows, int columnsA, int columnsB);
  /// Adds instead of writing, to blocks whose numbers are rounded up to eights. Several edges may share one, as in
  /// `Square`.
  static Cross addedCross(InstructionSet set, int rows, int columnsA, int columnsB);
  static Sum sum(InstructionSet set, int rows, int columns);

  /// Numbers that `Square` packs for one edge.
  static constexpr int squareSize(int columns) { return columns * (columns + 1) / 2 + columns; }
  static constexpr int paddedSize(int columns) { return recordNumbers(columns); }
};

}  // namespace quiver
