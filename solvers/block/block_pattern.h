#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace quiver {

/// Sizes and scalar positions of the block rows of a symmetric block matrix.
class BlockLayout {
 public:
  BlockLayout() = default;
  /// `dimensions[i]` ≥ 1 is the number of scalars of block i.
  explicit BlockLayout(std::vector<int> dimensions);

  int blocks() const { return static_cast<int>(dimensions_.size()); }
  int dimension(int block) const { return dimensions_[static_cast<std::size_t>(block)]; }
  /// First scalar of the block; offset(blocks()) == scalars().
  std::int64_t offset(int block) const { return offsets_[static_cast<std::size_t>(block)]; }
  std::int64_t scalars() const { return offsets_.back(); }
  std::span<const int> dimensions() const { return dimensions_; }
  /// The common dimension of all blocks, or 0 if they differ or there are none.
  int uniformDimension() const { return uniform_; }
  int largestDimension() const { return largest_; }

  bool operator==(const BlockLayout&) const = default;

 private:
  std::vector<int> dimensions_;
  std::vector<std::int64_t> offsets_ = {0};
  int uniform_ = 0;
  int largest_ = 0;
};

/// Which blocks of the lower triangle of a symmetric block matrix are stored: compressed block columns, the diagonal
/// block first, then rows in ascending order. Every diagonal block is present.
class BlockPattern {
 public:
  BlockPattern() = default;

  /// From pairs (row, column) in any order, repeated or not, in either triangle. O(pairs + blocks).
  static BlockPattern fromPairs(BlockLayout layout, std::span<const std::pair<int, int>> pairs);

  /// The pattern of P A Pᵀ: block `order[i]` of this pattern becomes block i of the result. O(entries).
  BlockPattern permuted(std::span<const int> order) const;

  const BlockLayout& layout() const { return layout_; }
  int blocks() const { return layout_.blocks(); }
  std::int64_t entries() const { return static_cast<std::int64_t>(rows_.size()); }
  std::int64_t columnBegin(int column) const { return columns_[static_cast<std::size_t>(column)]; }
  std::int64_t columnEnd(int column) const { return columns_[static_cast<std::size_t>(column) + 1]; }
  int row(std::int64_t entry) const { return rows_[static_cast<std::size_t>(entry)]; }
  std::span<const int> rows() const { return rows_; }
  /// Index of the entry (row ≥ column), or −1. O(log column length).
  std::int64_t find(int row, int column) const;

  bool operator==(const BlockPattern&) const = default;

 private:
  BlockLayout layout_;
  std::vector<std::int64_t> columns_ = {0};
  std::vector<int> rows_;
};

}  // namespace quiver
