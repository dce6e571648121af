#include <quiver/solvers/backends/scalar_columns.h>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

/// Calls visit(row, column, source) for every scalar of the lower triangle, block columns ascending, rows ascending in
/// every column.
template <typename Visit>
void forEachLowerScalar(const BlockPattern& pattern, const std::vector<std::int64_t>& offsets, const Visit& visit) {
  const BlockLayout& layout = pattern.layout();
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (int c = 0; c < layout.dimension(column); ++c) {
      for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
        const int row = pattern.row(k);
        const int dimension = layout.dimension(row);
        for (int r = row == column ? c : 0; r < dimension; ++r) {
          visit(layout.offset(row) + r, layout.offset(column) + c,
                offsets[static_cast<std::size_t>(k)] + c * dimension + r);
        }
      }
    }
  }
}

std::vector<std::int64_t> blockOffsets(const BlockPattern& pattern) {
  std::vector<std::int64_t> offsets;
  offsets.reserve(static_cast<std::size_t>(pattern.entries()));
  std::int64_t offset = 0;
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      offsets.push_back(offset);
      offset += std::int64_t{pattern.layout().dimension(pattern.row(k))} * pattern.layout().dimension(column);
    }
  }
  if (offset > std::numeric_limits<int>::max()) {
    throw LogicError(
        fmt::format("a matrix of {} stored scalars is too large for a solver with 32-bit indices", offset));
  }
  return offsets;
}

}  // namespace

ScalarColumns::ScalarColumns(const BlockPattern& pattern, Triangle triangle) {
  const std::vector<std::int64_t> offsets = blockOffsets(pattern);
  const auto scalars = static_cast<std::size_t>(pattern.layout().scalars());
  const bool upper = triangle == Triangle::upper;
  columns_.assign(scalars + 1, 0);
  forEachLowerScalar(pattern, offsets, [&](std::int64_t row, std::int64_t column, std::int64_t) {
    ++columns_[static_cast<std::size_t>(upper ? row : column) + 1];
  });
  for (std::size_t i = 0; i < scalars; ++i) columns_[i + 1] += columns_[i];
  rows_.resize(static_cast<std::size_t>(columns_.back()));
  source_.resize(rows_.size());
  diagonal_.resize(scalars);
  std::vector<int> next(columns_.begin(), columns_.end() - 1);
  forEachLowerScalar(pattern, offsets, [&](std::int64_t row, std::int64_t column, std::int64_t source) {
    const int k = next[static_cast<std::size_t>(upper ? row : column)]++;
    rows_[static_cast<std::size_t>(k)] = static_cast<int>(upper ? column : row);
    source_[static_cast<std::size_t>(k)] = source;
    if (row == column) diagonal_[static_cast<std::size_t>(row)] = k;
  });
}

void ScalarColumns::load(const BlockMatrix& matrix, std::span<const double> damping, double* values) const {
  const double* data = matrix.values().data();
  for (std::size_t k = 0; k < source_.size(); ++k) values[k] = data[source_[k]];
  for (std::size_t i = 0; i < damping.size(); ++i) values[diagonal_[i]] += damping[i];
}

std::pair<int, int> ScalarColumns::locate(const BlockLayout& layout, std::int64_t scalar) {
  int low = 0;
  int high = layout.blocks() - 1;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (layout.offset(middle) <= scalar) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return {low, static_cast<int>(scalar - layout.offset(low))};
}

}  // namespace quiver::detail
