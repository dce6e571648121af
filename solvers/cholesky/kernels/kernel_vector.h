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

constexpr int width = QUIVER_KERNEL_WIDTH;
using Lanes = VectorOf<width>::Type;

constexpr int larger(int a, int b) { return a > b ? a : b; }
constexpr int smaller(int a, int b) { return a < b ? a : b; }
constexpr int floor8(int a) { return a / 8 * 8; }
constexpr int ceil8(int a) { return (a + 7) / 8 * 8; }
