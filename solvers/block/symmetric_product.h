#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/solvers/block/block_matrix.h>

namespace quiver {

/// Products with a symmetric block matrix, row after row: for every block row its blocks of both triangles, so rows are
/// independent of each other and of the number of threads. Structure once, numbers many times.
class SymmetricProduct {
 public:
  SymmetricProduct() = default;
  /// O(entries).
  explicit SymmetricProduct(const BlockPattern& pattern);

  /// Rows [begin, end) of y = A x for a matrix of that pattern.
  void multiply(const BlockMatrix& matrix, const double* x, double* y, int begin, int end) const;
  std::int64_t bytes() const;

 private:
  struct Entry {
    std::int64_t block;  // of the lower triangle
    int other;           // the block column it meets
    bool transposed;
  };
  std::vector<std::int64_t> begin_ = {0};
  std::vector<Entry> entries_;
};

}  // namespace quiver
