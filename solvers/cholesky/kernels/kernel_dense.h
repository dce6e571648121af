// Dense kernels of a front: register tiles of several vectors of rows by up to six columns. Included by kernel_body.h.

/// Columns of a register tile.
constexpr int stripColumns = 6;
/// Vectors of rows of a register tile: as many as the registers of the instruction set hold.
constexpr int tileVectors = width == 8 ? 4 : 2;
/// Depth of a product that is accumulated in registers before memory is touched again.
constexpr int blockDepth = 96;

enum class Store { negate, subtract };

/// C = −A Bᵀ or C −= A Bᵀ for `vectors` vectors of rows and `columns` columns.
template <int vectors, int columns, Store mode>
inline __attribute__((always_inline)) void productTile(double* c, std::int64_t strideC, const double* a,
                                                       std::int64_t strideA, const double* b, std::int64_t strideB,
                                                       int depth) {
  Lanes sum[columns][vectors];
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) sum[j][v] = Lanes{};
  }
  for (int k = 0; k < depth; ++k) {
    Lanes rows[vectors];
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) rows[v] = load<width>(a + v * width);
#pragma GCC unroll 8
    for (int j = 0; j < columns; ++j) {
      const double factor = b[j];
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) sum[j][v] += rows[v] * factor;
    }
    a += strideA;
    b += strideB;
  }
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) {
      double* target = c + j * strideC + v * width;
      store<width>(target, mode == Store::negate ? -sum[j][v] : load<width>(target) - sum[j][v]);
    }
  }
}

template <int columns, Store mode>
void productRows(double* c, std::int64_t strideC, const double* a, std::int64_t strideA, const double* b,
                 std::int64_t strideB, int depth, int rows) {
  constexpr int tileRows = tileVectors * width;
  int r = 0;
  for (; r + tileRows <= rows; r += tileRows) {
    productTile<tileVectors, columns, mode>(c + r, strideC, a + r, strideA, b, strideB, depth);
  }
  if constexpr (tileVectors == 4) {
    const int left = (rows - r) / width;
    if (left == 3) productTile<3, columns, mode>(c + r, strideC, a + r, strideA, b, strideB, depth);
    if (left == 2) productTile<2, columns, mode>(c + r, strideC, a + r, strideA, b, strideB, depth);
    if (left == 1) productTile<1, columns, mode>(c + r, strideC, a + r, strideA, b, strideB, depth);
  }
}

/// The product for 1 … 6 columns, rows a multiple of 8.
template <Store mode>
void product(double* c, std::int64_t strideC, const double* a, std::int64_t strideA, const double* b,
             std::int64_t strideB, int depth, int rows, int columns) {
  switch (columns) {
    case 1:
      return productRows<1, mode>(c, strideC, a, strideA, b, strideB, depth, rows);
    case 2:
      return productRows<2, mode>(c, strideC, a, strideA, b, strideB, depth, rows);
    case 3:
      return productRows<3, mode>(c, strideC, a, strideA, b, strideB, depth, rows);
    case 4:
      return productRows<4, mode>(c, strideC, a, strideA, b, strideB, depth, rows);
    case 5:
      return productRows<5, mode>(c, strideC, a, strideA, b, strideB, depth, rows);
    default:
      return productRows<6, mode>(c, strideC, a, strideA, b, strideB, depth, rows);
  }
}

/// Fetches what goes along with the product of a register tile: a line of eight numbers to 384 multiply-adds.
inline __attribute__((always_inline)) void fetchUpcoming(UpcomingMemory* memory, int depth) {
  const std::int64_t left = memory->end - memory->begin;
  if (left <= 0) return;
  const std::int64_t numbers = depth * (tileVectors * width) / 64 * 8;
  const double* const end = memory->begin + (left < numbers ? left : numbers);
  const double* line = memory->begin;
  for (; line < end; line += 8) __builtin_prefetch(line, 1);
  memory->begin = line;
}

/// Columns [columnBegin, columnEnd) of C −= (or = −) A Bᵀ, rows [rowBegin, rowEnd) on or below C's diagonal; row r of B
/// belongs to column r of C. Walks row tiles outside and strips of columns inside, so that a tile of A stays in the
/// first-level cache.
template <Store mode>
void lowerProduct(double* c, std::int64_t strideC, const double* a, std::int64_t strideA, int depth, int columnBegin,
                  int columnEnd, int rowBegin, int rowEnd, UpcomingMemory* upcoming) {
  constexpr int tileRows = larger(tileVectors * width, 8);
  for (int r = larger(rowBegin, floor8(columnBegin)); r < rowEnd; r += tileRows) {
    const int end = smaller(r + tileRows, rowEnd);
    for (int j = columnBegin; j < columnEnd; j += stripColumns) {
      const int first = larger(r, floor8(j));
      if (first >= end) break;
      product<mode>(c + j * strideC + first, strideC, a + first, strideA, a + j, strideA, depth, end - first,
                    smaller(stripColumns, columnEnd - j));
      fetchUpcoming(upcoming, depth);
    }
  }
}

void updatePanel(double* panel, std::int64_t stride, int begin, int columns, int columnBegin, int columnEnd,
                 int rowBegin, int rowEnd, UpcomingMemory* upcoming) {
  lowerProduct<Store::subtract>(panel, stride, panel + begin * stride, stride, columns, columnBegin, columnEnd,
                                rowBegin, rowEnd, upcoming);
}

void formUpdate(double* update, std::int64_t updateStride, const double* below, std::int64_t stride, int depth,
                int columns, int rows, UpcomingMemory* upcoming) {
  lowerProduct<Store::negate>(update, updateStride, below, stride, smaller(depth, blockDepth), 0, columns, 0, rows,
                              upcoming);
  for (int k = blockDepth; k < depth; k += blockDepth) {
    lowerProduct<Store::subtract>(update, updateStride, below + k * stride, stride, smaller(depth - k, blockDepth), 0,
                                  columns, 0, rows, upcoming);
  }
}

/// Cholesky of a small diagonal block, column-major with the given stride; reciprocals of the diagonal go to `inverse`.
/// Works on the LDLᵀ form first, so that square roots stay off the chain of dependent operations.
template <int n>
inline __attribute__((always_inline)) int factorSmall(double* d, std::int64_t stride, double* inverse, double* pivot) {
  double a[n][n];
#pragma GCC unroll 9
  for (int j = 0; j < n; ++j) {
#pragma GCC unroll 9
    for (int i = j; i < n; ++i) a[j][i] = d[j * stride + i];
  }
#pragma GCC unroll 9
  for (int j = 0; j < n; ++j) {
    const double diagonal = a[j][j];
    if (!(diagonal > 0.0 && diagonal <= 1.7976931348623157e308)) {
      *pivot = diagonal;
      return j;
    }
    const double reciprocal = 1.0 / diagonal;
    const double root = __builtin_sqrt(diagonal) * reciprocal;  // both at once
    inverse[j] = root;
#pragma GCC unroll 9
    for (int k = j + 1; k < n; ++k) {
      const double factor = a[j][k] * reciprocal;
#pragma GCC unroll 9
      for (int i = k; i < n; ++i) a[k][i] -= a[j][i] * factor;
    }
#pragma GCC unroll 9
    for (int i = j; i < n; ++i) d[j * stride + i] = a[j][i] * root;
  }
  return -1;
}

inline int factorSmallOf(int n, double* d, std::int64_t stride, double* inverse, double* pivot) {
  switch (n) {
    case 1:
      return factorSmall<1>(d, stride, inverse, pivot);
    case 2:
      return factorSmall<2>(d, stride, inverse, pivot);
    case 3:
      return factorSmall<3>(d, stride, inverse, pivot);
    case 4:
      return factorSmall<4>(d, stride, inverse, pivot);
    case 5:
      return factorSmall<5>(d, stride, inverse, pivot);
    default:
      return factorSmall<6>(d, stride, inverse, pivot);
  }
}

/// Rows of a strip of columns: subtracts the product with the `depth` finished columns before it, then solves with the
/// strip's factored diagonal block, all in registers.
template <int vectors, int columns>
inline __attribute__((always_inline)) void solveTile(double* c, const double* a, const double* strip,
                                                     const double* diagonal, std::int64_t stride, int depth,
                                                     const double* inverse) {
  Lanes x[columns][vectors];
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j) {
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) x[j][v] = load<width>(c + j * stride + v * width);
  }
  for (int k = 0; k < depth; ++k) {
    Lanes rows[vectors];
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) rows[v] = load<width>(a + v * width);
#pragma GCC unroll 8
    for (int j = 0; j < columns; ++j) {
      const double factor = strip[j];
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) x[j][v] -= rows[v] * factor;
    }
    a += stride;
    strip += stride;
  }
#pragma GCC unroll 8
  for (int j = 0; j < columns; ++j) {
#pragma GCC unroll 8
    for (int i = 0; i < j; ++i) {
      const double factor = diagonal[i * stride + j];
#pragma GCC unroll 8
      for (int v = 0; v < vectors; ++v) x[j][v] -= x[i][v] * factor;
    }
#pragma GCC unroll 8
    for (int v = 0; v < vectors; ++v) {
      x[j][v] *= inverse[j];
      store<width>(c + j * stride + v * width, x[j][v]);
    }
  }
}

/// solveTile for every strip of the chunk, left to right, on one tile of rows.
template <int vectors>
void solveTileRows(double* panel, std::int64_t stride, int begin, int columns, int row, const double* inverse) {
  double* rows = panel + begin * stride + row;
  const double* chunk = panel + begin * stride + begin;
  for (int j = 0; j < columns; j += stripColumns) {
    double* c = rows + j * stride;
    const double* diagonal = chunk + j * stride + j;
    switch (smaller(stripColumns, columns - j)) {
      case 1:
        solveTile<vectors, 1>(c, rows, chunk + j, diagonal, stride, j, inverse + begin + j);
        break;
      case 2:
        solveTile<vectors, 2>(c, rows, chunk + j, diagonal, stride, j, inverse + begin + j);
        break;
      case 3:
        solveTile<vectors, 3>(c, rows, chunk + j, diagonal, stride, j, inverse + begin + j);
        break;
      case 4:
        solveTile<vectors, 4>(c, rows, chunk + j, diagonal, stride, j, inverse + begin + j);
        break;
      case 5:
        solveTile<vectors, 5>(c, rows, chunk + j, diagonal, stride, j, inverse + begin + j);
        break;
      default:
        solveTile<vectors, 6>(c, rows, chunk + j, diagonal, stride, j, inverse + begin + j);
        break;
    }
  }
}

void solveRows(double* panel, std::int64_t stride, int begin, int columns, int rowBegin, int rowEnd,
               const double* inverse) {
  constexpr int tileRows = tileVectors * width;
  int r = rowBegin;
  for (; r + tileRows <= rowEnd; r += tileRows) solveTileRows<tileVectors>(panel, stride, begin, columns, r, inverse);
  if constexpr (tileVectors == 4) {
    const int left = (rowEnd - r) / width;
    if (left == 3) solveTileRows<3>(panel, stride, begin, columns, r, inverse);
    if (left == 2) solveTileRows<2>(panel, stride, begin, columns, r, inverse);
    if (left == 1) solveTileRows<1>(panel, stride, begin, columns, r, inverse);
  }
}

int factorDiagonal(double* panel, std::int64_t stride, int begin, int columns, double* inverse, double* pivot) {
  double* chunk = panel + begin * stride + begin;
  const int rows = ceil8(columns);
  for (int j = 0; j < columns; j += stripColumns) {
    const int strip = smaller(stripColumns, columns - j);
    double* c = chunk + j * stride;
    const int first = floor8(j);
    if (j > 0)
      product<Store::subtract>(c + first, stride, chunk + first, stride, chunk + j, stride, j, rows - first, strip);
    const int failed = factorSmallOf(strip, c + j, stride, inverse + begin + j, pivot);
    if (failed >= 0) return j + failed;
    // Rows below the strip: one after the other until a whole group of eight starts.
    const double* diagonal = c + j;
    for (int r = j + strip; r < smaller(ceil8(j + strip), rows); ++r) {
      for (int k = 0; k < strip; ++k) {
        double x = c[k * stride + r];
        for (int i = 0; i < k; ++i) x -= c[i * stride + r] * diagonal[i * stride + k];
        c[k * stride + r] = x * inverse[begin + j + k];
      }
    }
    for (int r = ceil8(j + strip); r < rows; r += 8) {
      solveTile<8 / width, stripColumns>(c + r, chunk + r, chunk, diagonal, stride, 0, inverse + begin + j);
    }
  }
  return -1;
}
