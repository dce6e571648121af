// No include guard is needed but for tools: included by kernel_body.h, inside the namespace of the instruction set.
// Kernels on pairs of records: C −= Σ Z_row Z_columnᵀ, accumulated in registers over all pairs of a block.

/// Vectors for the rows of a record's body.
constexpr int rowWidth(int k) { return smaller(width, recordBody(k)); }

/// Subtracts the rows of the body that count from a column of K numbers.
template <int K, int vectors>
QUIVER_INLINE void subtractColumn(const typename VectorOf<rowWidth(K)>::Type* body, double* column) {
  constexpr int w = rowWidth(K);
  if constexpr (vectors * w <= K) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) store<w>(column + v * w, load<w>(column + v * w) - body[v]);
  } else {
    alignas(64) double line[vectors * w];
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) store<w>(line + v * w, body[v]);
    // Pieces that lie within what was stored at once are forwarded without waiting.
    int r = 0;
    if constexpr (w >= 4) {
      for (; r + 4 <= K; r += 4) store<4>(column + r, load<4>(column + r) - load<4>(line + r));
    }
    for (; r + 2 <= K; r += 2) store<2>(column + r, load<2>(column + r) - load<2>(line + r));
    if (r < K) column[r] -= line[r];
  }
}

/// Subtracts what one pass over the pairs accumulates: columns [first, first + columns) of the rows in the body of
/// C = Σ Z_row Z_columnᵀ, and, with the last columns, the rows of the tail, which run along the column record's body.
template <int KR, int KC, int E, int first, int columns, bool tails>
QUIVER_INLINE void subtractStrip(const double* tile, const RecordPair* pairs, std::int64_t count, double* block) {
  constexpr int w = rowWidth(KR);
  constexpr int vectors = (smaller(KR, recordBody(KR)) + w - 1) / w;
  constexpr int wc = rowWidth(KC);
  constexpr int across = (smaller(KC, recordBody(KC)) + wc - 1) / wc;
  constexpr int corner = larger(0, KC - recordBody(KC));
  constexpr int tail = tails ? larger(0, KR - recordBody(KR)) : 0;
  typename VectorOf<w>::Type body[columns][vectors] = {};
  typename VectorOf<wc>::Type along[tail + 1][across] = {};
  double last[tail + 1][corner + 1] = {};
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
        const double factor = column[recordEntry(KC, E, first + c, m)];
#pragma GCC unroll 8
        for (int v = 0; v < vectors; ++v) body[c][v] += rows[v] * factor;
      }
#pragma GCC unroll 2
      for (int t = 0; t < tail; ++t) {
        const double factor = row[recordEntry(KR, E, recordBody(KR) + t, m)];
#pragma GCC unroll 8
        for (int v = 0; v < across; ++v) along[t][v] += load<wc>(column + m * recordBody(KC) + v * wc) * factor;
#pragma GCC unroll 2
        for (int c = 0; c < corner; ++c) last[t][c] += column[recordEntry(KC, E, recordBody(KC) + c, m)] * factor;
      }
    }
  }
#pragma GCC unroll 9
  for (int c = 0; c < columns; ++c) subtractColumn<KR, vectors>(body[c], block + (first + c) * KR);
  for (int t = 0; t < tail; ++t) {
    double line[across * wc + corner + 1];
    for (int v = 0; v < across; ++v) store<wc>(line + v * wc, along[t][v]);
    for (int c = 0; c < corner; ++c) line[recordBody(KC) + c] = last[t][c];
    for (int c = 0; c < KC; ++c) block[c * KR + recordBody(KR) + t] -= line[c];
  }
}

/// Columns are taken in strips that leave registers for the operands.
template <int KR, int KC, int E, int first = 0>
QUIVER_INLINE void subtractStrips(const double* tile, const RecordPair* pairs, std::int64_t count, double* block) {
  constexpr int w = rowWidth(KR);
  constexpr int vectors = (smaller(KR, recordBody(KR)) + w - 1) / w;
  constexpr int registers = width == 8 ? 24 : 12;
  constexpr int strip = larger(1, smaller(9, registers / vectors));
  constexpr int columns = smaller(strip, KC - first);
  constexpr bool final = first + columns == KC;
  subtractStrip<KR, KC, E, first, columns, final>(tile, pairs, count, block);
  if constexpr (!final) subtractStrips<KR, KC, E, first + columns>(tile, pairs, count, block);
}

template <int KR, int KC, int E>
void subtractPairs(const double* tile, const RecordPair* pairs, std::int64_t count, int, int, int, double* block) {
  subtractStrips<KR, KC, E>(tile, pairs, count, block);
}

/// Subtracts the lower triangle of a symmetric block from both triangles: column c from row c on. `line` holds rows
/// [begin, end) of the column; row K is τ.
template <int K>
QUIVER_INLINE void subtractSymmetric(const double* line, int c, int begin, int end, double* block, double* right) {
  for (int r = larger(begin, c); r < smaller(end, K); ++r) {
    const double value = block[c * K + r] - line[r - begin];
    block[c * K + r] = value;
    block[r * K + c] = value;
  }
  if (end > K) right[c] -= line[K - begin];
}

/// C −= Σ Z Zᵀ and s −= Σ Z τ: rows of the body in whole vectors, column c from the four rows on that hold its
/// diagonal.
template <int K, int E>
void subtractSquares(const double* tile, const RecordPair* pairs, std::int64_t count, int, int, double* block,
                     double* right) {
  constexpr int w = rowWidth(K);
  constexpr int rows = recordBody(K);
  constexpr int vectors = rows / w;
  constexpr int columns = smaller(K, rows);
  constexpr int tail = recordTail(K);
  using Half = typename VectorOf<smaller(w, 4)>::Type;
  // Whether a column begins with half a vector: where its diagonal is in the second four rows of eight.
  constexpr auto halved = [](int c) { return w == 8 && c / 4 % 2 == 1; };
  typename VectorOf<w>::Type body[columns][vectors] = {};
  Half half[columns] = {};
  typename VectorOf<w>::Type along[tail + 1][vectors] = {};
  double last[tail + 1][tail + 1] = {};
  for (std::int64_t p = 0; p < count; ++p) {
    const double* record = tile + pairs[p].row * 8;
#pragma GCC unroll 4
    for (int m = 0; m < E; ++m) {
      const double* const column = record + m * rows;
      typename VectorOf<w>::Type z[vectors];
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) z[v] = load<w>(column + v * w);
#pragma GCC unroll 16
      for (int c = 0; c < columns; ++c) {
        if (halved(c)) half[c] += load<smaller(w, 4)>(column + c / 4 * 4) * column[c];
#pragma GCC unroll 8
        for (int v = c / w + (halved(c) ? 1 : 0); v < vectors; ++v) body[c][v] += z[v] * column[c];
      }
#pragma GCC unroll 2
      for (int t = 0; t < tail; ++t) {
        const double factor = record[recordEntry(K, E, rows + t, m)];
#pragma GCC unroll 8
        for (int v = 0; v < vectors; ++v) along[t][v] += z[v] * factor;
#pragma GCC unroll 2
        for (int u = 0; u <= t && rows + u < K; ++u) last[t][u] += record[recordEntry(K, E, rows + u, m)] * factor;
      }
    }
  }
  alignas(64) double line[rows];
  for (int c = 0; c < columns; ++c) {
    for (int v = 0; v < vectors; ++v) store<w>(line + v * w, body[c][v]);
    if (halved(c)) store<smaller(w, 4)>(line + c / 4 * 4, half[c]);
    subtractSymmetric<K>(line, c, 0, rows, block, right);
  }
  for (int t = 0; t < tail; ++t) {
    for (int v = 0; v < vectors; ++v) store<w>(line + v * w, along[t][v]);
    for (int c = 0; c < columns; ++c) subtractSymmetric<K>(line + c, c, rows + t, rows + t + 1, block, right);
    for (int u = 0; u <= t && rows + u < K; ++u)
      subtractSymmetric<K>(last[t] + u, rows + u, rows + t, rows + t + 1, block, right);
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
