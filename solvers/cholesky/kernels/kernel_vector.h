// Vectors of the width the translation unit is compiled for. No include guard is needed but for tools: included once by
// kernel_body.h, inside the namespace of the instruction set.

/// A vector of N doubles in registers; arithmetic with scalars broadcasts them.
template <int N>
struct VectorOf;
template <>
struct VectorOf<1> {
  using Type = double;
  using Memory = double;
};
template <>
struct VectorOf<2> {
  typedef double Type __attribute__((vector_size(16)));
  typedef double Memory __attribute__((vector_size(16), aligned(8), may_alias));
};
template <>
struct VectorOf<4> {
  typedef double Type __attribute__((vector_size(32)));
  typedef double Memory __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct VectorOf<8> {
  typedef double Type __attribute__((vector_size(64)));
  typedef double Memory __attribute__((vector_size(64), aligned(8), may_alias));
};

template <int N>
inline __attribute__((always_inline)) typename VectorOf<N>::Type load(const double* p) {
  return *reinterpret_cast<const typename VectorOf<N>::Memory*>(p);
}

template <int N>
inline __attribute__((always_inline)) void store(double* p, typename VectorOf<N>::Type v) {
  *reinterpret_cast<typename VectorOf<N>::Memory*>(p) = v;
}

/// `count` numbers and then zeros; reads no more.
template <int N, int count>
inline __attribute__((always_inline)) typename VectorOf<N>::Type loadFirst(const double* p) {
  if constexpr (count >= N) {
    return load<N>(p);
  } else if constexpr (count <= 0) {
    return typename VectorOf<N>::Type{};
  } else if constexpr (N == 2) {
    return VectorOf<2>::Type{p[0], 0.0};
  } else if constexpr (N == 4) {
    return __builtin_shufflevector(loadFirst<2, count>(p), loadFirst<2, count - 2>(p + 2), 0, 1, 2, 3);
  } else {
    return __builtin_shufflevector(loadFirst<4, count>(p), loadFirst<4, count - 4>(p + 4), 0, 1, 2, 3, 4, 5, 6, 7);
  }
}

/// Writes the first `count` ≥ 1 numbers and no others.
template <int N, int count>
inline __attribute__((always_inline)) void storeFirst(double* p, typename VectorOf<N>::Type v) {
  if constexpr (count >= N) {
    store<N>(p, v);
  } else if constexpr (N == 2) {
    p[0] = v[0];
  } else if constexpr (N == 4) {
    storeFirst<2, count>(p, __builtin_shufflevector(v, v, 0, 1));
    if constexpr (count > 2) storeFirst<2, count - 2>(p + 2, __builtin_shufflevector(v, v, 2, 3));
  } else {
    storeFirst<4, count>(p, __builtin_shufflevector(v, v, 0, 1, 2, 3));
    if constexpr (count > 4) storeFirst<4, count - 4>(p + 4, __builtin_shufflevector(v, v, 4, 5, 6, 7));
  }
}

constexpr int width = QUIVER_KERNEL_WIDTH;
using Lanes = VectorOf<width>::Type;

constexpr int larger(int a, int b) { return a > b ? a : b; }
constexpr int smaller(int a, int b) { return a < b ? a : b; }
constexpr int floor8(int a) { return a / 8 * 8; }
constexpr int ceil8(int a) { return (a + 7) / 8 * 8; }
