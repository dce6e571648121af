// Kernels on pairs of records: C −= Σ Z_row Z_columnᵀ, accumulated in registers over all pairs of a block.

/// Vectors for the rows of a record's body.
constexpr int rowWidth(int k) { return smaller(width, recordBody(k)); }

/// Entry (row, column) of a record whose sizes are constants.
template <int K, int E>
QUIVER_INLINE double entryOf(const double* record, int row, int column) {
  return record[recordEntry(K, E, row, column)];
}

/// Rows in the body of columns [first, first + columns) of Σ Z_row Z_columnᵀ; sum[c * stride + row].
template <int Rows, int KR, int KC, int E, int columns>
QUIVER_INLINE void sumBody(const double* tile, const RecordPair* pairs, std::int64_t count, int first, double* sum,
                           int stride) {
  constexpr int w = rowWidth(KR);
  constexpr int vectors = (smaller(Rows, recordBody(KR)) + w - 1) / w;
  typename VectorOf<w>::Type acc[columns][vectors];
#pragma GCC unroll 9
  for (int c = 0; c < columns; ++c) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) acc[c][v] = typename VectorOf<w>::Type{};
  }
  for (std::int64_t p = 0; p < count; ++p) {
    const double* row = tile + pairs[p].row * 8;
    const double* column = tile + pairs[p].column * 8;
#pragma GCC unroll 4
    for (int m = 0; m < E; ++m) {
      typename VectorOf<w>::Type rows[vectors];
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) rows[v] = load<w>(row + m * recordBody(KR) + v * w);
#pragma GCC unroll 9
      for (int c = 0; c < columns; ++c) {
        const double factor = entryOf<KC, E>(column, first + c, m);
#pragma GCC unroll 8
        for (int v = 0; v < vectors; ++v) acc[c][v] += rows[v] * factor;
      }
    }
  }
#pragma GCC unroll 9
  for (int c = 0; c < columns; ++c) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) store<w>(sum + (first + c) * stride + v * w, acc[c][v]);
  }
}

/// A row of the tail: one row of Σ Z_row Z_columnᵀ, accumulated over the column record's body.
template <int KR, int KC, int E>
QUIVER_INLINE void sumTail(const double* tile, const RecordPair* pairs, std::int64_t count, int tailRow, double* sum,
                           int stride) {
  constexpr int w = rowWidth(KC);
  constexpr int vectors = (smaller(KC, recordBody(KC)) + w - 1) / w;
  constexpr int corner = KC > recordBody(KC) ? KC - recordBody(KC) : 0;
  typename VectorOf<w>::Type acc[vectors];
#pragma GCC unroll 8
  for (int v = 0; v < vectors; ++v) acc[v] = typename VectorOf<w>::Type{};
  double last[corner + 1] = {};
  for (std::int64_t p = 0; p < count; ++p) {
    const double* row = tile + pairs[p].row * 8;
    const double* column = tile + pairs[p].column * 8;
#pragma GCC unroll 4
    for (int m = 0; m < E; ++m) {
      const double factor = entryOf<KR, E>(row, tailRow, m);
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) acc[v] += load<w>(column + m * recordBody(KC) + v * w) * factor;
      for (int c = 0; c < corner; ++c) last[c] += entryOf<KC, E>(column, recordBody(KC) + c, m) * factor;
    }
  }
  double across[vectors * w + corner + 1];
  for (int v = 0; v < vectors; ++v) store<w>(across + v * w, acc[v]);
  for (int c = 0; c < corner; ++c) across[recordBody(KC) + c] = last[c];
  for (int c = 0; c < KC; ++c) sum[c * stride + tailRow] = across[c];
}

/// Columns are taken in strips that leave registers for the operands.
template <int Rows, int KR, int KC, int E, int first = 0>
QUIVER_INLINE void sumStrips(const double* tile, const RecordPair* pairs, std::int64_t count, double* sum, int stride) {
  constexpr int w = rowWidth(KR);
  constexpr int vectors = (smaller(Rows, recordBody(KR)) + w - 1) / w;
  constexpr int registers = width == 8 ? 24 : 12;
  constexpr int strip = larger(1, smaller(9, registers / vectors));
  constexpr int columns = smaller(strip, KC - first);
  sumBody<Rows, KR, KC, E, columns>(tile, pairs, count, first, sum, stride);
  if constexpr (first + columns < KC) sumStrips<Rows, KR, KC, E, first + columns>(tile, pairs, count, sum, stride);
}

template <int KR, int KC, int E>
void subtractPairs(const double* tile, const RecordPair* pairs, std::int64_t count, int, int, int, double* block) {
  constexpr int stride = recordBody(KR) + recordTail(KR);
  alignas(64) double sum[stride * KC];
  sumStrips<KR, KR, KC, E>(tile, pairs, count, sum, stride);
  for (int row = recordBody(KR); row < KR; ++row) sumTail<KR, KC, E>(tile, pairs, count, row, sum, stride);
  for (int c = 0; c < KC; ++c) {
    for (int r = 0; r < KR; ++r) block[c * KR + r] -= sum[c * stride + r];
  }
}

template <int K, int E>
void subtractSquares(const double* tile, const RecordPair* pairs, std::int64_t count, int, int, double* block,
                     double* right) {
  constexpr int stride = recordBody(K) + recordTail(K);
  alignas(64) double sum[stride * K];
  sumStrips<K + 1, K, K, E>(tile, pairs, count, sum, stride);
  for (int row = recordBody(K); row <= K; ++row) sumTail<K, K, E>(tile, pairs, count, row, sum, stride);
  for (int c = 0; c < K; ++c) {
    for (int r = 0; r < K; ++r) block[c * K + r] -= sum[c * stride + r];
    right[c] -= sum[c * stride + K];
  }
}

// Sizes known at run time.

void subtractPairsLoop(const double* tile, const RecordPair* pairs, std::int64_t count, int kRow, int kColumn, int e,
                       double* block) {
  for (std::int64_t p = 0; p < count; ++p) {
    const double* row = tile + pairs[p].row * 8;
    const double* column = tile + pairs[p].column * 8;
    for (int m = 0; m < e; ++m) {
      for (int c = 0; c < kColumn; ++c) {
        const double factor = column[recordEntry(kColumn, e, c, m)];
        const int body = smaller(kRow, recordBody(kRow));
        for (int r = 0; r < body; ++r) block[c * kRow + r] -= row[m * recordBody(kRow) + r] * factor;
        for (int r = body; r < kRow; ++r) block[c * kRow + r] -= row[recordEntry(kRow, e, r, m)] * factor;
      }
    }
  }
}

void subtractSquaresLoop(const double* tile, const RecordPair* pairs, std::int64_t count, int k, int e, double* block,
                         double* right) {
  subtractPairsLoop(tile, pairs, count, k, k, e, block);
  for (std::int64_t p = 0; p < count; ++p) {
    const double* record = tile + pairs[p].row * 8;
    for (int m = 0; m < e; ++m) {
      const double tau = record[recordEntry(k, e, k, m)];
      for (int r = 0; r < k; ++r) right[r] -= record[recordEntry(k, e, r, m)] * tau;
    }
  }
}
