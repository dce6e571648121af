#include <quiver/solvers/block/block_matrix.h>

#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {

BlockMatrix::BlockMatrix(std::shared_ptr<const BlockPattern> pattern) : pattern_(std::move(pattern)) {
  const BlockLayout& layout = pattern_->layout();
  offsets_.assign(static_cast<std::size_t>(pattern_->entries()) + 1, 0);
  std::int64_t offset = 0;
  for (int column = 0; column < pattern_->blocks(); ++column) {
    for (std::int64_t k = pattern_->columnBegin(column); k < pattern_->columnEnd(column); ++k) {
      offsets_[static_cast<std::size_t>(k)] = offset;
      offset += std::int64_t{layout.dimension(pattern_->row(k))} * layout.dimension(column);
    }
  }
  offsets_.back() = offset;
  data_ = AlignedBuffer(offset);
}

void BlockMatrix::setZero() { std::fill(values().begin(), values().end(), 0.0); }

void BlockMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  const BlockLayout& layout = this->layout();
  if (static_cast<std::int64_t>(x.size()) != layout.scalars() || x.size() != y.size()) {
    throw LogicError(
        fmt::format("a product of {} scalars with vectors of {} and {}", layout.scalars(), x.size(), y.size()));
  }
  std::fill(y.begin(), y.end(), 0.0);
  for (int column = 0; column < layout.blocks(); ++column) {
    const int columns = layout.dimension(column);
    const double* xColumn = x.data() + layout.offset(column);
    double* yColumn = y.data() + layout.offset(column);
    for (std::int64_t k = pattern_->columnBegin(column); k < pattern_->columnEnd(column); ++k) {
      const int row = pattern_->row(k);
      const int rows = layout.dimension(row);
      const double* a = block(k);
      const double* xRow = x.data() + layout.offset(row);
      double* yRow = y.data() + layout.offset(row);
      for (int c = 0; c < columns; ++c) {
        double sum = 0.0;
        for (int r = 0; r < rows; ++r) {
          yRow[r] += a[c * rows + r] * xColumn[c];
          sum += a[c * rows + r] * xRow[r];
        }
        if (row != column) yColumn[c] += sum;
      }
    }
  }
}

void BlockMatrix::diagonal(std::span<double> out) const {
  const BlockLayout& layout = this->layout();
  for (int column = 0; column < layout.blocks(); ++column) {
    const int dimension = layout.dimension(column);
    const double* a = block(pattern_->columnBegin(column));
    for (int c = 0; c < dimension; ++c)
      out[static_cast<std::size_t>(layout.offset(column) + c)] = a[c * (dimension + 1)];
  }
}

}  // namespace quiver
