// Eight doubles as one value, of whatever vectors the translation unit is compiled for, and their transposition. No
// include guard is needed but for tools: included once by kernel_body.h, inside the namespace of the instruction set.

constexpr int parts = 8 / width;

struct Eight {
  Lanes part[parts];
};

#define QUIVER_INLINE inline __attribute__((always_inline))

QUIVER_INLINE Eight loadEight(const double* p) {
  Eight r;
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) r.part[i] = load<width>(p + i * width);
  return r;
}
QUIVER_INLINE void storeEight(double* p, const Eight& v) {
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) store<width>(p + i * width, v.part[i]);
}
QUIVER_INLINE Eight zeroEight() { return Eight{}; }
/// a b
QUIVER_INLINE Eight times(const Eight& a, const Eight& b) {
  Eight r;
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) r.part[i] = a.part[i] * b.part[i];
  return r;
}
/// c + a b
QUIVER_INLINE Eight plusProduct(const Eight& c, const Eight& a, const Eight& b) {
  Eight r;
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) r.part[i] = c.part[i] + a.part[i] * b.part[i];
  return r;
}
/// c − a b
QUIVER_INLINE Eight minusProduct(const Eight& c, const Eight& a, const Eight& b) {
  Eight r;
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) r.part[i] = c.part[i] - a.part[i] * b.part[i];
  return r;
}
QUIVER_INLINE Eight plus(const Eight& a, const Eight& b) {
  Eight r;
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) r.part[i] = a.part[i] + b.part[i];
  return r;
}

#if QUIVER_KERNEL_WIDTH == 8
QUIVER_INLINE void transposeSquare(Lanes* r) {
  Lanes a[8];
  Lanes b[8];
#  pragma GCC unroll 4
  for (int i = 0; i < 8; i += 2) {
    a[i] = __builtin_shufflevector(r[i], r[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    a[i + 1] = __builtin_shufflevector(r[i], r[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
#  pragma GCC unroll 2
  for (int i = 0; i < 8; i += 4) {
#  pragma GCC unroll 2
    for (int j = i; j < i + 2; ++j) {
      b[j] = __builtin_shufflevector(a[j], a[j + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      b[j + 2] = __builtin_shufflevector(a[j], a[j + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
#  pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    r[i] = __builtin_shufflevector(b[i], b[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    r[i + 4] = __builtin_shufflevector(b[i], b[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}
#elif QUIVER_KERNEL_WIDTH == 4
QUIVER_INLINE void transposeSquare(Lanes* r) {
  const Lanes a0 = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6);
  const Lanes a1 = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
  const Lanes a2 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6);
  const Lanes a3 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
  r[0] = __builtin_shufflevector(a0, a2, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(a1, a3, 0, 1, 4, 5);
  r[2] = __builtin_shufflevector(a0, a2, 2, 3, 6, 7);
  r[3] = __builtin_shufflevector(a1, a3, 2, 3, 6, 7);
}
#else
QUIVER_INLINE void transposeSquare(Lanes* r) {
  const Lanes a = __builtin_shufflevector(r[0], r[1], 0, 2);
  r[1] = __builtin_shufflevector(r[0], r[1], 1, 3);
  r[0] = a;
}
#endif

/// Transposes eight rows of eight: entry j of row i becomes entry i of row j.
QUIVER_INLINE void transposeEight(Eight* r) {
  Eight out[8];
#pragma GCC unroll 4
  for (int i = 0; i < parts; ++i) {
#pragma GCC unroll 4
    for (int j = 0; j < parts; ++j) {
      Lanes square[width];
#pragma GCC unroll 8
      for (int m = 0; m < width; ++m) square[m] = r[i * width + m].part[j];
      transposeSquare(square);
#pragma GCC unroll 8
      for (int m = 0; m < width; ++m) out[j * width + m].part[i] = square[m];
    }
  }
#pragma GCC unroll 8
  for (int m = 0; m < 8; ++m) r[m] = out[m];
}

/// Turns eight lane numbers into eight consecutive doubles of each lane's memory, at `offset`.
template <bool add>
QUIVER_INLINE void scatterEight(Eight* r, double* const* out, int offset) {
  transposeEight(r);
#pragma GCC unroll 8
  for (int lane = 0; lane < 8; ++lane) {
    double* target = out[lane] + offset;
    storeEight(target, add ? plus(loadEight(target), r[lane]) : r[lane]);
  }
}

/// The inverse: eight consecutive doubles of each lane's memory become eight lane numbers.
QUIVER_INLINE void gatherEight(const double* const* in, int offset, Eight* r) {
#pragma GCC unroll 8
  for (int lane = 0; lane < 8; ++lane) r[lane] = loadEight(in[lane] + offset);
  transposeEight(r);
}
