#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>
#include <quiver/solvers/block/block_pattern.h>

namespace quiver {

/// A symmetric block-sparse matrix: values of the lower triangle over a fixed pattern.
///
/// Block (i, j), i ≥ j, is a dense column-major array of dimension(i) × dimension(j) doubles, one after the other in
/// the order of the pattern's entries: column by column, so a factorisation that walks the columns streams. Diagonal
/// blocks are stored whole and symmetric. 64-byte aligned start.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// Shares the pattern; all values are zero.
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern);

  const BlockPattern& pattern() const { return *pattern_; }
  const BlockLayout& layout() const { return pattern_->layout(); }
  double* block(std::int64_t entry) { return data_.data() + offsets_[static_cast<std::size_t>(entry)]; }
  const double* block(std::int64_t entry) const { return data_.data() + offsets_[static_cast<std::size_t>(entry)]; }
  std::int64_t offset(std::int64_t entry) const { return offsets_[static_cast<std::size_t>(entry)]; }
  std::span<double> values() { return {data_.data(), static_cast<std::size_t>(offsets_.back())}; }
  std::span<const double> values() const { return {data_.data(), static_cast<std::size_t>(offsets_.back())}; }
  void setZero();

  /// y = A x for the whole symmetric matrix; x and y have layout().scalars() entries and do not overlap. O(values).
  void multiply(std::span<const double> x, std::span<double> y) const;
  /// The scalar diagonal. O(scalars).
  void diagonal(std::span<double> out) const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<std::int64_t> offsets_ = {0};
  AlignedBuffer data_;
};

}  // namespace quiver
