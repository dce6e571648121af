#include <quiver/solvers/block/block_pattern.h>

#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {

BlockLayout::BlockLayout(std::vector<int> dimensions) : dimensions_(std::move(dimensions)) {
  offsets_.assign(dimensions_.size() + 1, 0);
  bool uniform = !dimensions_.empty();
  for (std::size_t i = 0; i < dimensions_.size(); ++i) {
    const int dimension = dimensions_[i];
    if (dimension < 1) throw LogicError(fmt::format("block {} has dimension {}", i, dimension));
    offsets_[i + 1] = offsets_[i] + dimension;
    largest_ = std::max(largest_, dimension);
    uniform = uniform && dimension == dimensions_.front();
  }
  uniform_ = uniform ? dimensions_.front() : 0;
}

namespace {

/// Sorts each column's rows and drops repetitions, in place. Rows are below the diagonal only.
void sortColumns(std::vector<std::int64_t>& columns, std::vector<int>& rows) {
  std::int64_t write = 0;
  std::int64_t begin = 0;
  for (std::size_t column = 0; column + 1 < columns.size(); ++column) {
    const std::int64_t end = columns[column + 1];
    std::sort(rows.begin() + begin, rows.begin() + end);
    const std::int64_t first = write;
    for (std::int64_t k = begin; k < end; ++k) {
      if (write == first || rows[static_cast<std::size_t>(write - 1)] != rows[static_cast<std::size_t>(k)]) {
        rows[static_cast<std::size_t>(write++)] = rows[static_cast<std::size_t>(k)];
      }
    }
    begin = end;
    columns[column + 1] = write;
  }
  rows.resize(static_cast<std::size_t>(write));
}

/// Compressed columns of the given entries (row, column) plus the diagonal; `forEach(visit)` calls visit(row, column),
/// row ≥ column.
template <typename ForEach>
void compress(int blocks, const ForEach& forEach, std::vector<std::int64_t>& columns, std::vector<int>& rows) {
  columns.assign(static_cast<std::size_t>(blocks) + 1, 0);
  for (int i = 0; i < blocks; ++i) columns[static_cast<std::size_t>(i) + 1] = 1;
  forEach([&](int row, int column) {
    if (row != column) ++columns[static_cast<std::size_t>(column) + 1];
  });
  for (int i = 0; i < blocks; ++i) columns[static_cast<std::size_t>(i) + 1] += columns[static_cast<std::size_t>(i)];
  rows.resize(static_cast<std::size_t>(columns.back()));
  std::vector<std::int64_t> next(columns.begin(), columns.end() - 1);
  for (int i = 0; i < blocks; ++i) rows[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = i;
  forEach([&](int row, int column) {
    if (row != column) rows[static_cast<std::size_t>(next[static_cast<std::size_t>(column)]++)] = row;
  });
  sortColumns(columns, rows);
}

}  // namespace

BlockPattern BlockPattern::fromPairs(BlockLayout layout, std::span<const std::pair<int, int>> pairs) {
  BlockPattern pattern;
  pattern.layout_ = std::move(layout);
  const int blocks = pattern.layout_.blocks();
  for (const auto& [i, j] : pairs) {
    if (i < 0 || j < 0 || i >= blocks || j >= blocks) {
      throw LogicError(fmt::format("block pair ({}, {}) outside of {} blocks", i, j, blocks));
    }
  }
  compress(
      blocks,
      [&](const auto& visit) {
        for (const auto& [i, j] : pairs) visit(std::max(i, j), std::min(i, j));
      },
      pattern.columns_, pattern.rows_);
  return pattern;
}

BlockPattern BlockPattern::permuted(std::span<const int> order) const {
  const int count = blocks();
  if (static_cast<int>(order.size()) != count) {
    throw LogicError(fmt::format("an order of {} for {} blocks", order.size(), count));
  }
  std::vector<int> position(static_cast<std::size_t>(count), -1);  // position[old block] = new block
  std::vector<int> dimensions(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const int old = order[static_cast<std::size_t>(i)];
    if (old < 0 || old >= count || position[static_cast<std::size_t>(old)] >= 0) {
      throw LogicError(fmt::format("not a permutation of {} blocks: entry {} is {}", count, i, old));
    }
    position[static_cast<std::size_t>(old)] = i;
    dimensions[static_cast<std::size_t>(i)] = layout_.dimension(old);
  }
  BlockPattern result;
  result.layout_ = BlockLayout(std::move(dimensions));
  compress(
      count,
      [&](const auto& visit) {
        for (int column = 0; column < count; ++column) {
          const int newColumn = position[static_cast<std::size_t>(column)];
          for (std::int64_t k = columnBegin(column); k < columnEnd(column); ++k) {
            const int newRow = position[static_cast<std::size_t>(row(k))];
            visit(std::max(newRow, newColumn), std::min(newRow, newColumn));
          }
        }
      },
      result.columns_, result.rows_);
  return result;
}

std::int64_t BlockPattern::find(int row, int column) const {
  const auto begin = rows_.begin() + columnBegin(column);
  const auto end = rows_.begin() + columnEnd(column);
  const auto it = std::lower_bound(begin, end, row);
  return it != end && *it == row ? it - rows_.begin() : -1;
}

}  // namespace quiver
