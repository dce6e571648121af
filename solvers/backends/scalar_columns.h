#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <quiver/solvers/block/block_matrix.h>

namespace quiver::detail {

/// One triangle of a block matrix as compressed scalar columns, for solvers that know no blocks: positions once, values
/// many times.
class ScalarColumns {
 public:
  enum class Triangle { lower, upper };

  ScalarColumns() = default;
  /// Throws LogicError if the triangle has more than 2³¹ − 1 scalars. O(scalars of the pattern).
  ScalarColumns(const BlockPattern& pattern, Triangle triangle);

  int size() const { return static_cast<int>(columns_.size()) - 1; }
  const std::vector<int>& columns() const { return columns_; }
  /// Ascending in every column.
  const std::vector<int>& rows() const { return rows_; }
  /// Writes the values of matrix + diag(damping), one for each of rows(); `damping` may be empty.
  void load(const BlockMatrix& matrix, std::span<const double> damping, double* values) const;
  /// The block a scalar belongs to, and which of its coordinates it is.
  static std::pair<int, int> locate(const BlockLayout& layout, std::int64_t scalar);

 private:
  std::vector<int> columns_ = {0};
  std::vector<int> rows_;
  std::vector<std::int64_t> source_;  // of each value, in BlockMatrix::values()
  std::vector<int> diagonal_;         // of each column, in rows_
};

}  // namespace quiver::detail
