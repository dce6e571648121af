// Addition of children's update matrices, and substitution through a front. Included by kernel_body.h.

/// target += source. Runs are short (one or a few blocks), so the tail goes in halves instead of a loop.
inline __attribute__((always_inline)) void addRun(double* target, const double* source, int length) {
  int i = 0;
  for (; i + 8 <= length; i += 8) store<8>(target + i, load<8>(target + i) + load<8>(source + i));
  if (length & 4) {
    store<4>(target + i, load<4>(target + i) + load<4>(source + i));
    i += 4;
  }
  if (length & 2) {
    store<2>(target + i, load<2>(target + i) + load<2>(source + i));
    i += 2;
  }
  if (length & 1) target[i] += source[i];
}

void addChild(const double* child, UpdateLayout layout, const RowRun* runs, int count, double* target,
              std::int64_t targetStride, int shift, int begin, int end) {
  UpdateColumns offsetOf(layout);
  for (int q = 0; q < count; ++q) {
    const RowRun& run = runs[q];
    if (run.destination >= end) break;
    const int first = larger(run.destination, begin);
    const int last = smaller(run.destination + run.length, end);
    for (int d = first; d < last;) {
      const int c = run.source + d - run.destination;
      const double* const from = child + offsetOf(c);
      double* const to = target + (d - shift) * targetStride - shift;
      // A few columns run by run: the lengths of runs differ, and a branch is right more often when it repeats itself.
      const int columns = smaller(stripColumns, smaller(offsetOf.stripEnd() - c, last - d));
      const std::int64_t stride = offsetOf.stride();
      for (int i = 0; i < columns; ++i)
        addRun(to + i * targetStride + d + i, from + i * stride + c + i, run.source + run.length - c - i);
      for (int k = q + 1; k < count; ++k) {
        for (int i = 0; i < columns; ++i)
          addRun(to + i * targetStride + runs[k].destination, from + i * stride + runs[k].source, runs[k].length);
      }
      d += columns;
    }
  }
}

/// v[r] −= Σ_j column_j[r] x[j] for `columns` columns and rows [begin, end), begin and end multiples of 8.
template <int columns>
inline __attribute__((always_inline)) void subtractColumns(double* v, const double* panel, std::int64_t stride,
                                                           const double* x, int begin, int end) {
  for (int r = begin; r < end; r += width) {
    Lanes sum = load<width>(v + r);
#pragma GCC unroll 8
    for (int j = 0; j < columns; ++j) sum -= load<width>(panel + j * stride + r) * x[j];
    store<width>(v + r, sum);
  }
}

void forward(const double* panel, std::int64_t stride, int columns, int rows, const double* inverse, double* v) {
  for (int j = 0; j < columns; j += stripColumns) {
    const int strip = smaller(stripColumns, columns - j);
    const double* c = panel + j * stride;
    for (int k = 0; k < strip; ++k) {
      double x = v[j + k];
      for (int i = 0; i < k; ++i) x -= c[i * stride + j + k] * v[j + i];
      v[j + k] = x * inverse[j + k];
    }
    const int aligned = ceil8(j + strip);
    for (int r = j + strip; r < aligned; ++r) {
      for (int k = 0; k < strip; ++k) v[r] -= c[k * stride + r] * v[j + k];
    }
    if (strip == stripColumns) {
      subtractColumns<stripColumns>(v, c, stride, v + j, aligned, rows);
    } else {
      for (int k = 0; k < strip; ++k) subtractColumns<1>(v, c + k * stride, stride, v + j + k, aligned, rows);
    }
  }
}

inline double sumOf(Lanes v) {
  double sum = v[0];
#pragma GCC unroll 8
  for (int i = 1; i < width; ++i) sum += v[i];
  return sum;
}

/// x[j] −= Σ_r column_j[r] v[r] over rows [begin, end), begin and end multiples of 8.
template <int columns>
inline __attribute__((always_inline)) void subtractProducts(double* x, const double* panel, std::int64_t stride,
                                                            const double* v, int begin, int end) {
  Lanes sum[columns];
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j) sum[j] = Lanes{};
  for (int r = begin; r < end; r += width) {
    const Lanes rows = load<width>(v + r);
#pragma GCC unroll 8
    for (int j = 0; j < columns; ++j) sum[j] += load<width>(panel + j * stride + r) * rows;
  }
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j) x[j] -= sumOf(sum[j]);
}

void backward(const double* panel, std::int64_t stride, int columns, int rows, const double* inverse, double* v) {
  const int strips = (columns + stripColumns - 1) / stripColumns;
  for (int s = strips - 1; s >= 0; --s) {
    const int j = s * stripColumns;
    const int strip = smaller(stripColumns, columns - j);
    const double* c = panel + j * stride;
    const int aligned = ceil8(j + strip);
    if (strip == stripColumns) {
      subtractProducts<stripColumns>(v + j, c, stride, v, aligned, rows);
    } else {
      for (int k = 0; k < strip; ++k) subtractProducts<1>(v + j + k, c + k * stride, stride, v, aligned, rows);
    }
    for (int k = strip - 1; k >= 0; --k) {
      double x = v[j + k];
      for (int r = j + k + 1; r < aligned; ++r) x -= c[k * stride + r] * v[r];
      v[j + k] = x * inverse[j + k];
    }
  }
}
