#include <quiver/solvers/block/symmetric_product.h>

#include <algorithm>

namespace quiver {

SymmetricProduct::SymmetricProduct(const BlockPattern& pattern) {
  const auto blocks = static_cast<std::size_t>(pattern.blocks());
  begin_.assign(blocks + 1, 0);
  const auto forEach = [&](const auto& visit) {
    for (int column = 0; column < pattern.blocks(); ++column) {
      for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
        visit(pattern.row(k), Entry{k, column, false});
        if (pattern.row(k) != column) visit(column, Entry{k, pattern.row(k), true});
      }
    }
  };
  forEach([&](int row, const Entry&) { ++begin_[static_cast<std::size_t>(row) + 1]; });
  for (std::size_t i = 0; i < blocks; ++i) begin_[i + 1] += begin_[i];
  entries_.resize(static_cast<std::size_t>(begin_.back()));
  std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
  forEach([&](int row, const Entry& entry) {
    entries_[static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++)] = entry;
  });
}

void SymmetricProduct::multiply(const BlockMatrix& matrix, const double* x, double* y, int begin, int end) const {
  const BlockLayout& layout = matrix.layout();
  for (int row = begin; row < end; ++row) {
    const int rows = layout.dimension(row);
    double* out = y + layout.offset(row);
    std::fill_n(out, rows, 0.0);
    for (std::int64_t k = begin_[static_cast<std::size_t>(row)]; k < begin_[static_cast<std::size_t>(row) + 1]; ++k) {
      const Entry& entry = entries_[static_cast<std::size_t>(k)];
      const double* a = matrix.block(entry.block);
      const double* in = x + layout.offset(entry.other);
      const int others = layout.dimension(entry.other);
      if (entry.transposed) {
        for (int r = 0; r < rows; ++r, a += others) {
          double sum = 0.0;
          for (int c = 0; c < others; ++c) sum += a[c] * in[c];
          out[r] += sum;
        }
      } else {
        for (int c = 0; c < others; ++c, a += rows) {
          for (int r = 0; r < rows; ++r) out[r] += a[r] * in[c];
        }
      }
    }
  }
}

std::int64_t SymmetricProduct::bytes() const {
  return static_cast<std::int64_t>(begin_.size() * sizeof(begin_[0]) + entries_.size() * sizeof(Entry));
}

}  // namespace quiver
