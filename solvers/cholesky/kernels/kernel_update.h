// Columns of update matrices, and products of leaf panels. Included by kernel_body.h.

/// Ascending columns of an update matrix.
class UpdateColumns {
 public:
  explicit inline __attribute__((always_inline)) UpdateColumns(UpdateLayout layout)
      : width_(layout.width), stride_(layout.rows) {}

  /// Where row 0 of a column would be, counted from the matrix's first double. Not before the last column asked for.
  inline __attribute__((always_inline)) std::int64_t operator()(int column) {
    while (column >= row_ + width_) {
      begin_ += stride_ * width_;
      stride_ -= width_;
      row_ += width_;
    }
    return begin_ + (column - row_) * stride_ - row_;
  }
  /// Of the strip of the last column: the distance of its columns, and the column behind it.
  std::int64_t stride() const { return stride_; }
  int stripEnd() const { return row_ + width_; }

 private:
  int width_;
  int row_ = 0;
  std::int64_t stride_;
  std::int64_t begin_ = 0;
};

/// U −= P Pᵀ on and below the diagonal, where P has the given runs of U's rows.
__attribute__((noinline)) void subtractPanel(const LeafUpdate& update, const LeafPanel& shape, const RowRun* runs,
                                             int depth, UpcomingMemory* upcoming) {
  const double* const panel = update.panel;
  const std::int64_t stride = shape.stride;
  UpdateColumns offsetOf(update.layout);
  for (int p = 0; p < shape.runCount; ++p) {
    const int end = runs[p].destination + runs[p].length;
    const double* rows = panel + runs[p].source - floor8(runs[p].destination);  // of U
    for (int column = runs[p].destination; column < end;) {
      double* const c = update.values + offsetOf(column);
      const int columns = smaller(smaller(stripColumns, end - column), offsetOf.stripEnd() - column);
      const double* b = rows + column;
      const int first = floor8(column);
      product<Store::subtract>(c + first, offsetOf.stride(), rows + first, stride, b, stride, depth, ceil8(end) - first,
                               columns);
      fetchUpcoming(upcoming, depth);
      for (int q = p + 1; q < shape.runCount; ++q) {
        const int begin = floor8(runs[q].destination);
        product<Store::subtract>(c + begin, offsetOf.stride(), panel + runs[q].source, stride, b, stride, depth,
                                 ceil8(runs[q].destination + runs[q].length) - begin, columns);
        fetchUpcoming(upcoming, depth);
      }
      column += columns;
    }
  }
}
