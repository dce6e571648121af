// Leaf subtrees: every block of L alone, destinations of all products known beforehand. Included by kernel_body.h.

/// The vectors a column of a leaf block of dimension b consists of.
template <int b>
struct LeafBlock {
  static constexpr int stride = leafStride(b);
  static constexpr int place = leafPlace(b);
  static constexpr bool padded = stride == place;
  static constexpr int lanes = place % 8 == 0 && width == 8 ? 8 : smaller(place % 4 == 0 ? 4 : place, larger(width, 1));
  static constexpr int vectors = place / lanes;
  static constexpr int size = stride * b;
  using Vector = typename VectorOf<lanes>::Type;
};

/// Copies the columns of a block of H.
template <int b, int k = 0>
inline __attribute__((always_inline)) void copyBlock(double* to, const double* from) {
  if constexpr (k < b * b) {
    constexpr int lanes = LeafBlock<b>::lanes;
    storeFirst<lanes, smaller(lanes, b * b - k)>(to + k, loadFirst<lanes, smaller(lanes, b * b - k)>(from + k));
    copyBlock<b, k + lanes>(to, from);
  }
}

template <int b, int v = 0>
inline __attribute__((always_inline)) void padColumn(double* to, const double* from) {
  using Block = LeafBlock<b>;
  if constexpr (v < Block::vectors) {
    store<Block::lanes>(to + v * Block::lanes, loadFirst<Block::lanes, b - v * Block::lanes>(from + v * Block::lanes));
    padColumn<b, v + 1>(to, from);
  }
}

template <int b>
void leafLoad(const LeafView& leaf, const LoadEntry* loads, const std::int64_t* begin, const double* source,
              double* values) {
  using Block = LeafBlock<b>;
  // The last vector may reach into the next block, whose turn comes after.
  const auto clear = [](double* block, const double* end) {
    for (; block != end; block += Block::size) {
#pragma GCC unroll 32
      for (int k = 0; k < Block::size; k += Block::lanes) store<Block::lanes>(block + k, typename Block::Vector{});
    }
  };
  double* next = values;  // columns follow each other
  for (int j = 0; j < leaf.count; ++j) {
    double* const end = next + (leaf.columns[j].below + 1) * Block::size;
    for (std::int64_t k = begin[j]; k < begin[j + 1]; ++k) {
      double* const block = values + loads[k].destination;
      const double* const from = source + loads[k].source;
      clear(next, block);
      if constexpr (Block::padded) {
#pragma GCC unroll 9
        for (int c = 0; c < b; ++c) padColumn<b>(block + c * Block::stride, from + c * b);
      } else {
        copyBlock<b>(block, from);
      }
      next = block + Block::size;
    }
    clear(next, end);
    next = end;
  }
  // What vectors reach behind the last block is multiplied by zeros: it must be finite.
  for (int k = 0; k < 8; ++k) next[k] = 0.0;
}

/// Where numbers go: to blocks with their padding, or into a matrix whose next rows follow at once.
enum class Target { block, matrix };

/// Vector v of a block's column is written. In a matrix nothing is written behind the block: reading the next block
/// would wait until that has left the store buffer.
template <int b, Target target, int v = 0>
inline __attribute__((always_inline)) void storeColumn(double* p, const typename LeafBlock<b>::Vector* values) {
  using Block = LeafBlock<b>;
  if constexpr (v < Block::vectors) {
    constexpr int count = target == Target::block && Block::padded ? Block::lanes : b - v * Block::lanes;
    if constexpr (count > 0) storeFirst<Block::lanes, count>(p + v * Block::lanes, values[v]);
    storeColumn<b, target, v + 1>(p, values);
  }
}

/// x ← x L⁻ᵀ for one block, L the factored diagonal block of the column.
template <int b>
inline __attribute__((always_inline)) void scaleBlock(double* x, const double* diagonal, const double* inverse) {
  using Block = LeafBlock<b>;
  typename Block::Vector columns[b][Block::vectors];
#pragma GCC unroll 9
  for (int c = 0; c < b; ++c) {
#pragma GCC unroll 4
    for (int v = 0; v < Block::vectors; ++v) {
      auto value = load<Block::lanes>(x + c * Block::stride + v * Block::lanes);
#pragma GCC unroll 9
      for (int k = 0; k < c; ++k) value -= columns[k][v] * diagonal[k * Block::stride + c];
      columns[c][v] = value * inverse[c];
    }
    storeColumn<b, Target::block>(x + c * Block::stride, columns[c]);
  }
}

/// C −= A Bᵀ for `blocks` blocks A one after the other in memory, their C wherever targets say.
template <int b, Target target, int blocks>
inline __attribute__((always_inline)) void subtractProduct(double* const* targets, std::int64_t strideC,
                                                           const double* a, const double* factor) {
  using Block = LeafBlock<b>;
  typename Block::Vector sum[blocks][b][Block::vectors];
#pragma GCC unroll 2
  for (int i = 0; i < blocks; ++i) {
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) {
#pragma GCC unroll 4
      for (int v = 0; v < Block::vectors; ++v)
        sum[i][c][v] = load<Block::lanes>(targets[i] + c * strideC + v * Block::lanes);
    }
  }
#pragma GCC unroll 9
  for (int k = 0; k < b; ++k) {
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) {
      const double value = factor[k * Block::stride + c];
#pragma GCC unroll 2
      for (int i = 0; i < blocks; ++i) {
#pragma GCC unroll 4
        for (int v = 0; v < Block::vectors; ++v) {
          sum[i][c][v] -= load<Block::lanes>(a + i * Block::size + k * Block::stride + v * Block::lanes) * value;
        }
      }
    }
  }
#pragma GCC unroll 2
  for (int i = 0; i < blocks; ++i) {
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) storeColumn<b, target>(targets[i] + c * strideC, sum[i][c]);
  }
}

/// C −= A Bᵀ with the values of B in registers, for dimensions that leave room. In a matrix, columns are read in the
/// pieces in which they are written: the columns of a chain add to the same places one soon after the other, and a
/// vector that spans several unfinished writes waits for them all.
template <int b, Target target, typename Vector>
inline __attribute__((always_inline)) void subtractSmallProduct(double* c, std::int64_t strideC, const double* a,
                                                                const Vector (&factor)[b * b]) {
  using Block = LeafBlock<b>;
  static_assert(Block::vectors == 1);
  constexpr int numbers = target == Target::block ? Block::lanes : b;
  Vector rows[b];
#pragma GCC unroll 9
  for (int k = 0; k < b; ++k) rows[k] = load<Block::lanes>(a + k * Block::stride);
#pragma GCC unroll 9
  for (int column = 0; column < b; ++column) {
    Vector sum = loadFirst<Block::lanes, numbers>(c + column * strideC);
#pragma GCC unroll 9
    for (int k = 0; k < b; ++k) sum -= rows[k] * factor[k * b + column];
    storeColumn<b, target>(c + column * strideC, &sum);
  }
}

/// All products of one block (at `factor`) with itself and the blocks after it; targetOf(i) is where the i-th goes.
template <int b, Target target, typename TargetOf>
inline __attribute__((always_inline)) void subtractProducts(const double* factor, int count, std::int64_t strideC,
                                                            const TargetOf& targetOf) {
  using Block = LeafBlock<b>;
  const double* a = factor;
  int i = 0;
  if constexpr (b <= 3 && Block::vectors == 1) {
    using Vector = typename Block::Vector;
    Vector values[b * b];
#pragma GCC unroll 9
    for (int k = 0; k < b * b; ++k) values[k] = factor[k / b * Block::stride + k % b] - Vector{};
    for (; i < count; ++i, a += Block::size) subtractSmallProduct<b, target, Vector>(targetOf(i), strideC, a, values);
  } else {
    constexpr int together = b > 3 && 2 * b * Block::vectors <= (width == 8 ? 24 : 12) ? 2 : 1;
    if constexpr (together == 2) {
      for (; i + 2 <= count; i += 2, a += 2 * Block::size) {
        double* targets[2] = {targetOf(i), targetOf(i + 1)};
        subtractProduct<b, target, 2>(targets, strideC, a, factor);
      }
    }
    for (; i < count; ++i, a += Block::size) {
      double* targets[1] = {targetOf(i)};
      subtractProduct<b, target, 1>(targets, strideC, a, factor);
    }
  }
}

/// Inverts the lower triangle of a factored diagonal block into the free half above its diagonal: entry (r, c) of L⁻¹,
/// r > c, lies at row c of column r. Multiplying by it makes a shorter chain of dependent operations than substituting.
template <int b>
inline __attribute__((always_inline)) void invertDiagonal(double* diagonal, const double* reciprocal) {
  constexpr int stride = leafStride(b);
#pragma GCC unroll 9
  for (int c = 0; c < b; ++c) {
#pragma GCC unroll 9
    for (int r = c + 1; r < b; ++r) {
      double sum = diagonal[c * stride + r] * reciprocal[c];
#pragma GCC unroll 9
      for (int k = c + 1; k < r; ++k) sum += diagonal[k * stride + r] * diagonal[k * stride + c];
      diagonal[r * stride + c] = -sum * reciprocal[r];
    }
  }
}

/// Products of a column's blocks outside the subtree, which start at `factor`, are subtracted from the update matrix.
template <int b>
inline __attribute__((always_inline)) void subtractOutside(const LeafView& leaf, const LeafColumn& column,
                                                           const double* factor, double* update, UpdateLayout layout) {
  constexpr bool oneStrip = b < leastPanelDimension;
  const std::int64_t rows = layout.rows;
  UpdateColumns offsetOf(layout);
  for (int q = column.inside; q < column.below; ++q, factor += LeafBlock<b>::size) {
    const std::int32_t* positions = leaf.positions + column.rows + q;
    double* const target = update + (oneStrip ? positions[0] * rows : offsetOf(positions[0]));
    subtractProducts<b, Target::matrix>(factor, column.below - q, oneStrip ? rows : offsetOf.stride(),
                                        [=](int i) { return target + positions[i]; });
  }
}

/// Divides the blocks below by the factored diagonal, and subtracts the products of all pairs of them, but for those
/// that a panel takes.
template <int b>
inline __attribute__((always_inline)) void eliminateLeafColumn(const LeafView& leaf, const LeafColumn& column,
                                                               double* values, const double* inverse, double* update,
                                                               UpdateLayout layout) {
  using Block = LeafBlock<b>;
  const double* const diagonal = values + column.values;
  double* const below = values + column.values + Block::size;
  for (int i = 0; i < column.below; ++i) scaleBlock<b>(below + i * Block::size, diagonal, inverse + column.scalar);
  const std::int32_t* destinations = leaf.destinations + column.destinations;
  const double* factor = below;
  for (int q = 0; q < column.inside; ++q, factor += Block::size) {
    const int count = column.below - q;
    subtractProducts<b, Target::block>(factor, count, Block::stride, [=](int i) { return values + destinations[i]; });
    destinations += count;
  }
  if (b < leastPanelDimension || column.inPanel == 0) subtractOutside<b>(leaf, column, factor, update, layout);
}

/// Copies the blocks outside of a panel's columns into it.
template <int b>
__attribute__((noinline)) void gatherPanel(const LeafView& leaf, const LeafPanel& panel, const double* values,
                                           double* target) {
  using Block = LeafBlock<b>;
  const std::int64_t stride = panel.stride;
  __builtin_memset(target, 0, static_cast<unsigned long>((panel.last - panel.first + 1) * b * stride) * sizeof(double));
  for (int j = panel.first; j <= panel.last; ++j, target += b * stride) {
    const LeafColumn& column = leaf.columns[j];
    const std::int32_t* positions = leaf.positions + column.rows;
    const double* block = values + column.values + (1 + column.inside) * Block::size;
    const RowRun* run = leaf.panelRuns + panel.runs;
    for (int i = column.inside; i < column.below; ++i, block += Block::size) {
      while (positions[i] >= run->destination + run->length) ++run;
      double* to = target + (run->source + positions[i] - floor8(run->destination));
#pragma GCC unroll 9
      for (int c = 0; c < b; ++c) {
        typename Block::Vector numbers[Block::vectors];
#pragma GCC unroll 4
        for (int v = 0; v < Block::vectors; ++v)
          numbers[v] = load<Block::lanes>(block + c * Block::stride + v * Block::lanes);
        storeColumn<b, Target::matrix>(to + c * stride, numbers);
      }
    }
  }
}

template <int b>
int leafFactor(const LeafView& leaf, double* values, double* inverse, const LeafUpdate& update, double* pivot,
               [[maybe_unused]] UpcomingMemory* upcoming) {
  [[maybe_unused]] const LeafPanel* next = leaf.panels;
  for (int j = 0; j < leaf.count;) {
    const int end = j + leaf.columns[j].group;
    for (int k = j; k < end; ++k) {
      const LeafColumn& column = leaf.columns[k];
      double* const diagonal = values + column.values;
      const int failed = factorSmall<b>(diagonal, LeafBlock<b>::stride, inverse + column.scalar, pivot);
      if (failed >= 0) return k * b + failed;
      invertDiagonal<b>(diagonal, inverse + column.scalar);
    }
    for (; j < end; ++j) eliminateLeafColumn<b>(leaf, leaf.columns[j], values, inverse, update.values, update.layout);
    if constexpr (b >= leastPanelDimension) {
      for (; next->last < j; ++next) {
        gatherPanel<b>(leaf, *next, values, update.panel);
        subtractPanel(update, *next, leaf.panelRuns + next->runs, (next->last - next->first + 1) * b, upcoming);
      }
    }
  }
  return -1;
}

/// Copies blocks of b doubles that are `strideFrom` apart to places `strideTo` apart.
template <int b>
inline __attribute__((always_inline)) void copyBlocks(double* to, int strideTo, const double* from, int strideFrom,
                                                      int count) {
  for (int i = 0; i < count; ++i, to += strideTo, from += strideFrom) {
#pragma GCC unroll 9
    for (int r = 0; r < b; ++r) to[r] = from[r];
  }
}

/// The same into padded blocks.
template <int b>
inline __attribute__((always_inline)) void padBlocks(double* to, const double* from, int count) {
  constexpr int place = leafPlace(b);
  for (int i = 0; i < count; ++i, to += place, from += b) {
#pragma GCC unroll 12
    for (int r = 0; r < place; ++r) to[r] = r < b ? from[r] : 0.0;
  }
}

template <int b>
void leafForward(const LeafView& leaf, const double* values, const double* inverse, double* x, double* v,
                 double* update) {
  using Block = LeafBlock<b>;
  double* outside = v + leaf.count * Block::place;
  padBlocks<b>(v, x, leaf.count);
  for (int i = 0; i < leaf.outside * Block::place; ++i) outside[i] = 0.0;
  for (int j = 0; j < leaf.count; ++j) {
    const LeafColumn& column = leaf.columns[j];
    const double* block = values + column.values;
    const double* reciprocal = inverse + column.scalar;
    double* own = v + j * Block::place;
    double y[b];
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) {
      y[c] = own[c] * reciprocal[c];
#pragma GCC unroll 9
      for (int k = 0; k < c; ++k) y[c] += block[c * Block::stride + k] * own[k];
    }
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) own[c] = y[c];
    const std::int32_t* rows = leaf.rows + column.rows;
    for (int i = 0; i < column.below; ++i) {
      block += Block::size;
      double* target = v + rows[i];
#pragma GCC unroll 12
      for (int k = 0; k < Block::vectors; ++k) {
        auto sum = load<Block::lanes>(target + k * Block::lanes);
#pragma GCC unroll 9
        for (int c = 0; c < b; ++c) sum -= load<Block::lanes>(block + c * Block::stride + k * Block::lanes) * y[c];
        store<Block::lanes>(target + k * Block::lanes, sum);
      }
    }
  }
  copyBlocks<b>(x, b, v, Block::place, leaf.count);
  copyBlocks<b>(update, b, outside, Block::place, leaf.outside);
}

inline double sumOfLanes(double v) { return v; }
inline double sumOfLanes(VectorOf<2>::Type v) { return v[0] + v[1]; }
inline double sumOfLanes(VectorOf<4>::Type v) { return (v[0] + v[2]) + (v[1] + v[3]); }
inline double sumOfLanes(VectorOf<8>::Type v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

template <int b>
void leafBackward(const LeafView& leaf, const double* values, const double* inverse, double* x, double* v) {
  using Block = LeafBlock<b>;
  padBlocks<b>(v, x, leaf.count);
  for (int j = leaf.count - 1; j >= 0; --j) {
    const LeafColumn& column = leaf.columns[j];
    const double* diagonal = values + column.values;
    const double* reciprocal = inverse + column.scalar;
    const double* block = diagonal;
    const std::int32_t* rows = leaf.rows + column.rows;
    // Columns lie in memory in the order of j: going down, no hardware sees the next one coming.
    const double* next = values + leaf.columns[j > 0 ? j - 1 : 0].values;
    typename Block::Vector sums[b] = {};
    for (int i = 0; i < column.below; ++i) {
      block += Block::size;
#pragma GCC unroll 12
      for (int k = 0; k < Block::size; k += 8) __builtin_prefetch(next + k);
      next += Block::size;
      const double* source = v + rows[i];
#pragma GCC unroll 12
      for (int k = 0; k < Block::vectors; ++k) {
        const auto values = load<Block::lanes>(source + k * Block::lanes);
#pragma GCC unroll 9
        for (int c = 0; c < b; ++c)
          sums[c] += load<Block::lanes>(block + c * Block::stride + k * Block::lanes) * values;
      }
    }
    double* own = v + j * Block::place;
    double y[b];
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) y[c] = own[c] - sumOfLanes(sums[c]);
    double solution[b];
#pragma GCC unroll 9
    for (int c = 0; c < b; ++c) {
      solution[c] = y[c] * reciprocal[c];
#pragma GCC unroll 9
      for (int k = c + 1; k < b; ++k) solution[c] += diagonal[k * Block::stride + c] * y[k];
    }
    if constexpr (b == 3 && Block::lanes == 4) {
      store<4>(own, VectorOf<4>::Type{solution[0], solution[1], solution[2], 0.0});
    } else {
#pragma GCC unroll 9
      for (int c = 0; c < b; ++c) own[c] = solution[c];
    }
  }
  copyBlocks<b>(x, b, v, Block::place, leaf.count);
}
