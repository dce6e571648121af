// No include guard is needed but for tools: included by kernel_body.h, inside the namespace of the instruction set.
// Kernels on rows of eight edges. Template sizes of 0 stand for sizes known at run time.

template <int fixed>
QUIVER_INLINE int sizeOf(int given) {
  return fixed > 0 ? fixed : given;
}

template <int N, int E>
void addPoint(const double* J, const double* residual, int givenN, int givenE, double* sums) {
  const int n = sizeOf<N>(givenN);
  const int e = sizeOf<E>(givenE);
  double* out = sums;
  for (int a = 0; a < e; ++a) {
    for (int b = a; b < e; ++b, out += 8) {
      Eight sum = loadEight(out);
      for (int r = 0; r < n; ++r)
        sum = plusProduct(sum, loadEight(J + (a * n + r) * 8), loadEight(J + (b * n + r) * 8));
      storeEight(out, sum);
    }
  }
  for (int a = 0; a < e; ++a, out += 8) {
    Eight sum = loadEight(out);
    for (int r = 0; r < n; ++r) sum = plusProduct(sum, loadEight(J + (a * n + r) * 8), loadEight(residual + r * 8));
    storeEight(out, sum);
  }
}

/// Where entry (row, column), row ≥ column, of a factor lies: number in lanes.
QUIVER_INLINE int lowerEntry(int e, int row, int column) {
  return column * e - column * (column - 1) / 2 + row - column;
}

/// 1/√pivot where the pivot is sound, else 0, and then adds 1 to `dropped`. Compares vectors: a branch for each of
/// eight points would cost more than all the rest of their factors.
QUIVER_INLINE Eight reciprocalRoot(const Eight& pivot, const Eight& diagonal, double floor, Eight& dropped) {
  Eight inverse;
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) {
    const Lanes value = pivot.part[i];
    const auto sound = (value > floor * diagonal.part[i]) & (value > 0.0) & (value <= 1.7976931348623157e308);
    const Lanes one = Lanes{} + 1.0;
    const Lanes usable = sound ? value : one;
    double root[width];
    store<width>(root, usable);
    for (int lane = 0; lane < width; ++lane) root[lane] = __builtin_sqrt(root[lane]);
    inverse.part[i] = sound ? one / load<width>(root) : Lanes{};
    dropped.part[i] += sound ? Lanes{} : one;
  }
  return inverse;
}

template <int E>
void factorPoint(const double* sums, const double* damping, int givenE, double floor, double* factor, double* dropped) {
  const int e = sizeOf<E>(givenE);
  Eight lost = zeroEight();
  for (int j = 0; j < e; ++j) {
    double* column = factor + lowerEntry(e, j, j) * 8;
    const Eight diagonal = plus(loadEight(sums + lowerEntry(e, j, j) * 8), loadEight(damping + j * 8));
    Eight inverse{};
    for (int i = j; i < e; ++i) {
      Eight sum = i == j ? diagonal : loadEight(sums + lowerEntry(e, i, j) * 8);
      for (int m = 0; m < j; ++m)
        sum =
            minusProduct(sum, loadEight(factor + lowerEntry(e, i, m) * 8), loadEight(factor + lowerEntry(e, j, m) * 8));
      if (i == j) inverse = reciprocalRoot(sum, diagonal, floor, lost);
      storeEight(column + (i - j) * 8, i == j ? inverse : times(sum, inverse));
    }
  }
  storeEight(dropped, lost);
  const double* g = sums + e * (e + 1) / 2 * 8;
  double* tau = factor + e * (e + 1) / 2 * 8;
  for (int j = 0; j < e; ++j) {
    Eight sum = loadEight(g + j * 8);
    for (int m = 0; m < j; ++m)
      sum = minusProduct(sum, loadEight(factor + lowerEntry(e, j, m) * 8), loadEight(tau + m * 8));
    storeEight(tau + j * 8, times(sum, loadEight(factor + lowerEntry(e, j, j) * 8)));
  }
}

template <int E>
void solvePoint(const double* factor, int givenE, double* t) {
  const int e = sizeOf<E>(givenE);
  for (int j = 0; j < e; ++j) {
    Eight sum = loadEight(t + j * 8);
    for (int m = 0; m < j; ++m)
      sum = minusProduct(sum, loadEight(factor + lowerEntry(e, j, m) * 8), loadEight(t + m * 8));
    storeEight(t + j * 8, times(sum, loadEight(factor + lowerEntry(e, j, j) * 8)));
  }
  for (int j = e - 1; j >= 0; --j) {
    Eight sum = loadEight(t + j * 8);
    for (int m = j + 1; m < e; ++m)
      sum = minusProduct(sum, loadEight(factor + lowerEntry(e, m, j) * 8), loadEight(t + m * 8));
    storeEight(t + j * 8, times(sum, loadEight(factor + lowerEntry(e, j, j) * 8)));
  }
}

/// Y = Jₑ L⁻ᵀ, column by column.
template <int N, int E>
QUIVER_INLINE void whitenPoint(const double* Je, const double* factor, int n, int e, Eight* y) {
  for (int j = 0; j < e; ++j) {
    for (int r = 0; r < n; ++r) {
      Eight sum = loadEight(Je + (j * n + r) * 8);
      for (int m = 0; m < j; ++m) sum = minusProduct(sum, y[m * n + r], loadEight(factor + lowerEntry(e, j, m) * 8));
      y[j * n + r] = times(sum, loadEight(factor + lowerEntry(e, j, j) * 8));
    }
  }
}

/// Number `at` of a record in lanes: an entry of Z, of τ (zero when records are added to), or padding.
template <int N, int K, int E, bool add>
QUIVER_INLINE Eight recordNumber(int at, const double* Jk, const double* tau, const Eight* y, int n, int k, int e) {
  const int body = recordBody(k);
  const int row = at < e * body ? at % body : body + (at - e * body) / e;
  const int column = at < e * body ? at / body : (at - e * body) % e;
  if (row > k || (add && row == k)) return zeroEight();
  if (row == k) return loadEight(tau + column * 8);
  Eight sum = times(loadEight(Jk + row * n * 8), y[column * n]);
#pragma GCC unroll 4
  for (int r = 1; r < n; ++r) sum = plusProduct(sum, loadEight(Jk + (row * n + r) * 8), y[column * n + r]);
  return sum;
}

template <int N, int K, int E, bool add>
QUIVER_INLINE void reduceRecords(const double* Jk, const double* tau, const Eight* y, int n, int k, int e,
                                 double* const* records) {
  const int size = recordSize(k, e);
#pragma GCC unroll 8
  for (int begin = 0; begin < size; begin += 8) {
    Eight r[8];
#pragma GCC unroll 8
    for (int i = 0; i < 8; ++i) r[i] = recordNumber<N, K, E, add>(begin + i, Jk, tau, y, n, k, e);
    scatterEight<add>(r, records, begin);
  }
}

template <int N, int K, int E>
void reduceRow(const double* Jk, const double* Je, const double* factor, int givenN, int givenK, int givenE, bool add,
               double* scratch, double* const* records) {
  const int n = sizeOf<N>(givenN);
  const int k = sizeOf<K>(givenK);
  const int e = sizeOf<E>(givenE);
  const double* tau = factor + e * (e + 1) / 2 * 8;
  if constexpr (N > 0) {
    Eight y[N * E];
    whitenPoint<N, E>(Je, factor, n, e, y);
    if (add) {
      reduceRecords<N, K, E, true>(Jk, tau, y, n, k, e, records);
    } else {
      reduceRecords<N, K, E, false>(Jk, tau, y, n, k, e, records);
    }
  } else {
    auto* y = reinterpret_cast<Eight*>(scratch);
    whitenPoint<N, E>(Je, factor, n, e, y);
    if (add) {
      reduceRecords<N, K, E, true>(Jk, tau, y, n, k, e, records);
    } else {
      reduceRecords<N, K, E, false>(Jk, tau, y, n, k, e, records);
    }
  }
}

template <int N, int K>
void multiplyRow(const double* J, const double* const* x, int givenN, int givenK, double* u) {
  const int n = sizeOf<N>(givenN);
  const int k = sizeOf<K>(givenK);
#pragma GCC unroll 2
  for (int begin = 0; begin < k; begin += 8) {
    Eight v[8];
    gatherEight(x, begin, v);
    for (int r = 0; r < n; ++r) {
      Eight sum = loadEight(u + r * 8);
#pragma GCC unroll 8
      for (int c = 0; c < 8; ++c) {
        if (begin + c < k) sum = plusProduct(sum, loadEight(J + ((begin + c) * n + r) * 8), v[c]);
      }
      storeEight(u + r * 8, sum);
    }
  }
}

template <int N, int E>
void transposedRow(const double* J, const double* u, int givenN, int givenE, double* t) {
  const int n = sizeOf<N>(givenN);
  const int e = sizeOf<E>(givenE);
  for (int c = 0; c < e; ++c) {
    Eight sum = loadEight(t + c * 8);
    for (int r = 0; r < n; ++r) sum = plusProduct(sum, loadEight(J + (c * n + r) * 8), loadEight(u + r * 8));
    storeEight(t + c * 8, sum);
  }
}

template <int N, int K>
void scatterRow(const double* J, const double* u, int givenN, int givenK, double* const* y) {
  const int n = sizeOf<N>(givenN);
  const int k = sizeOf<K>(givenK);
#pragma GCC unroll 2
  for (int begin = 0; begin < k; begin += 8) {
    Eight v[8];
#pragma GCC unroll 8
    for (int c = 0; c < 8; ++c) {
      v[c] = zeroEight();
      if (begin + c >= k) continue;
      for (int r = 0; r < n; ++r)
        v[c] = plusProduct(v[c], loadEight(J + ((begin + c) * n + r) * 8), loadEight(u + r * 8));
    }
    scatterEight<true>(v, y, begin);
  }
}
