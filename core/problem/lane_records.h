#pragma once

#include <cstdint>

#include <quiver/geometry/scalar/lanes.h>

namespace quiver::detail {

// Moving numbers between memory and lanes, by instruction set. Each function is inlined into the batch loop of its set.

/// out[k] lane i = pointers[i][k], k < Size: eight records become lanes. May read up to the next multiple of eight
/// numbers behind a record.
template <int Size, typename Isa>
inline void loadRecords(const double* const* pointers, Lanes<Isa>* out) {
  for (int k = 0; k < Size; ++k) {
    for (int i = 0; i < 8; ++i) out[k].v[i] = pointers[i][k];
  }
}

/// The inverse: pointers[i][k] = in[k] lane i, k < Size. Writes exactly Size numbers.
template <int Size, typename Isa>
inline void storeRecords(const Lanes<Isa>* in, double* const* pointers) {
  for (int k = 0; k < Size; ++k) {
    for (int i = 0; i < 8; ++i) pointers[i][k] = in[k].v[i];
  }
}

/// pointers[i][k] += in[k] lane i, k < Size. Records that several pointers share get their parts
/// in order of i.
template <int Size, typename Isa>
inline void addRecords(const Lanes<Isa>* in, double* const* pointers) {
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < Size; ++k) pointers[i][k] += in[k].v[i];
  }
}

template <typename Isa>
inline void storeLanes(const Lanes<Isa>& value, double* out) {
  for (int i = 0; i < 8; ++i) out[i] = value.v[i];
}
template <typename Isa>
inline void loadLanes(const double* in, Lanes<Isa>& value) {
  for (int i = 0; i < 8; ++i) value.v[i] = in[i];
}

#if QUIVER_NATIVE_LANES

typedef double Native8 __attribute__((vector_size(64), aligned(8), may_alias));
typedef std::int64_t Index8 __attribute__((vector_size(64)));
typedef double Native4 __attribute__((vector_size(32), aligned(8), may_alias));
typedef std::int64_t Index4 __attribute__((vector_size(32)));

QUIVER_TARGET_AVX512 inline void storeLanes(const Lanes<isa::Avx512>& value, double* out) {
  *reinterpret_cast<Native8*>(out) = *reinterpret_cast<const Native8*>(value.v);
}
QUIVER_TARGET_AVX512 inline void loadLanes(const double* in, Lanes<isa::Avx512>& value) {
  *reinterpret_cast<Native8*>(value.v) = *reinterpret_cast<const Native8*>(in);
}
QUIVER_TARGET_AVX2 inline void storeLanes(const Lanes<isa::Avx2>& value, double* out) {
  reinterpret_cast<Native4*>(out)[0] = reinterpret_cast<const Native4*>(value.v)[0];
  reinterpret_cast<Native4*>(out)[1] = reinterpret_cast<const Native4*>(value.v)[1];
}
QUIVER_TARGET_AVX2 inline void loadLanes(const double* in, Lanes<isa::Avx2>& value) {
  reinterpret_cast<Native4*>(value.v)[0] = reinterpret_cast<const Native4*>(in)[0];
  reinterpret_cast<Native4*>(value.v)[1] = reinterpret_cast<const Native4*>(in)[1];
}

/// Transposes eight rows of eight in registers: 24 shuffles.
#  define QUIVER_TRANSPOSE8(r)                                                                   \
    {                                                                                            \
      const Index8 low = {0, 8, 2, 10, 4, 12, 6, 14}, high = {1, 9, 3, 11, 5, 13, 7, 15};        \
      const Index8 low2 = {0, 1, 8, 9, 4, 5, 12, 13}, high2 = {2, 3, 10, 11, 6, 7, 14, 15};      \
      const Index8 low4 = {0, 1, 2, 3, 8, 9, 10, 11}, high4 = {4, 5, 6, 7, 12, 13, 14, 15};      \
      Native8 a0 = __builtin_shuffle(r[0], r[1], low), a1 = __builtin_shuffle(r[0], r[1], high); \
      Native8 a2 = __builtin_shuffle(r[2], r[3], low), a3 = __builtin_shuffle(r[2], r[3], high); \
      Native8 a4 = __builtin_shuffle(r[4], r[5], low), a5 = __builtin_shuffle(r[4], r[5], high); \
      Native8 a6 = __builtin_shuffle(r[6], r[7], low), a7 = __builtin_shuffle(r[6], r[7], high); \
      Native8 b0 = __builtin_shuffle(a0, a2, low2), b1 = __builtin_shuffle(a1, a3, low2);        \
      Native8 b2 = __builtin_shuffle(a0, a2, high2), b3 = __builtin_shuffle(a1, a3, high2);      \
      Native8 b4 = __builtin_shuffle(a4, a6, low2), b5 = __builtin_shuffle(a5, a7, low2);        \
      Native8 b6 = __builtin_shuffle(a4, a6, high2), b7 = __builtin_shuffle(a5, a7, high2);      \
      r[0] = __builtin_shuffle(b0, b4, low4), r[1] = __builtin_shuffle(b1, b5, low4);            \
      r[2] = __builtin_shuffle(b2, b6, low4), r[3] = __builtin_shuffle(b3, b7, low4);            \
      r[4] = __builtin_shuffle(b0, b4, high4), r[5] = __builtin_shuffle(b1, b5, high4);          \
      r[6] = __builtin_shuffle(b2, b6, high4), r[7] = __builtin_shuffle(b3, b7, high4);          \
    }

/// Transposes eight records of four numbers, the i-th and the one four behind it in r[i], or back: eight shuffles.
#  define QUIVER_TRANSPOSE4(r)                                                                   \
    {                                                                                            \
      const Index8 low = {0, 8, 2, 10, 4, 12, 6, 14}, high = {1, 9, 3, 11, 5, 13, 7, 15};        \
      const Index8 low2 = {0, 1, 8, 9, 4, 5, 12, 13}, high2 = {2, 3, 10, 11, 6, 7, 14, 15};      \
      Native8 a0 = __builtin_shuffle(r[0], r[1], low), a1 = __builtin_shuffle(r[0], r[1], high); \
      Native8 a2 = __builtin_shuffle(r[2], r[3], low), a3 = __builtin_shuffle(r[2], r[3], high); \
      r[0] = __builtin_shuffle(a0, a2, low2), r[1] = __builtin_shuffle(a1, a3, low2);            \
      r[2] = __builtin_shuffle(a0, a2, high2), r[3] = __builtin_shuffle(a1, a3, high2);          \
    }

template <int Size>
QUIVER_TARGET_AVX512 inline void loadRecords(const double* const* pointers, Lanes<isa::Avx512>* out) {
  constexpr int whole = Size % 8 > 4 ? (Size + 7) / 8 * 8 : Size / 8 * 8;
  for (int k = 0; k < whole; k += 8) {
    Native8 r[8];
    for (int i = 0; i < 8; ++i) r[i] = *reinterpret_cast<const Native8*>(pointers[i] + k);
    QUIVER_TRANSPOSE8(r)
    for (int i = 0; i < 8 && k + i < Size; ++i) *reinterpret_cast<Native8*>(out[k + i].v) = r[i];
  }
  if constexpr (whole < Size) {
    Native8 r[4];
    for (int i = 0; i < 4; ++i) {
      r[i] =
          __builtin_shufflevector(*reinterpret_cast<const Native4*>(pointers[i] + whole),
                                  *reinterpret_cast<const Native4*>(pointers[i + 4] + whole), 0, 1, 2, 3, 4, 5, 6, 7);
    }
    QUIVER_TRANSPOSE4(r)
    for (int i = 0; i < 4 && whole + i < Size; ++i) *reinterpret_cast<Native8*>(out[whole + i].v) = r[i];
  }
}

template <int Size>
QUIVER_TARGET_AVX512 inline void addRecords(const Lanes<isa::Avx512>* in, double* const* pointers) {
  constexpr int whole = Size / 8 * 8;
  for (int k = 0; k < whole; k += 8) {
    Native8 r[8];
    for (int i = 0; i < 8; ++i) r[i] = *reinterpret_cast<const Native8*>(in[k + i].v);
    QUIVER_TRANSPOSE8(r)
    for (int i = 0; i < 8; ++i) *reinterpret_cast<Native8*>(pointers[i] + k) += r[i];
  }
  if constexpr (Size - whole == 4) {
    Native8 r[4];
    for (int i = 0; i < 4; ++i) r[i] = *reinterpret_cast<const Native8*>(in[whole + i].v);
    QUIVER_TRANSPOSE4(r)
    for (int i = 0; i < 4; ++i)
      *reinterpret_cast<Native4*>(pointers[i] + whole) += __builtin_shufflevector(r[i], r[i], 0, 1, 2, 3);
    for (int i = 0; i < 4; ++i)
      *reinterpret_cast<Native4*>(pointers[i + 4] + whole) += __builtin_shufflevector(r[i], r[i], 4, 5, 6, 7);
  } else {
    for (int i = 0; i < 8; ++i) {
      for (int k = whole; k < Size; ++k) pointers[i][k] += in[k].v[i];
    }
  }
}

template <int Size>
QUIVER_TARGET_AVX512 inline void storeRecords(const Lanes<isa::Avx512>* in, double* const* pointers) {
  constexpr int whole = Size / 8 * 8;
  for (int k = 0; k < whole; k += 8) {
    Native8 r[8];
    for (int i = 0; i < 8; ++i) r[i] = *reinterpret_cast<const Native8*>(in[k + i].v);
    QUIVER_TRANSPOSE8(r)
    for (int i = 0; i < 8; ++i) *reinterpret_cast<Native8*>(pointers[i] + k) = r[i];
  }
  if constexpr (Size - whole == 4) {
    Native8 r[4];
    for (int i = 0; i < 4; ++i) r[i] = *reinterpret_cast<const Native8*>(in[whole + i].v);
    QUIVER_TRANSPOSE4(r)
    for (int i = 0; i < 4; ++i) {
      *reinterpret_cast<Native4*>(pointers[i] + whole) = __builtin_shufflevector(r[i], r[i], 0, 1, 2, 3);
      *reinterpret_cast<Native4*>(pointers[i + 4] + whole) = __builtin_shufflevector(r[i], r[i], 4, 5, 6, 7);
    }
  } else {
    for (int k = whole; k < Size; ++k) {
      for (int i = 0; i < 8; ++i) pointers[i][k] = in[k].v[i];
    }
  }
}

#endif  // QUIVER_NATIVE_LANES

/// Where entry `at` of an upper triangle of order D, row by row, followed by D numbers of a column of their own, lies;
/// (D, D) behind the last.
struct TriangleEntry {
  int row;
  int column;
};
template <int D>
constexpr TriangleEntry triangleEntry(int at) {
  int row = 0;
  for (; row < D && at >= D - row; ++row) at -= D - row;
  return row < D ? TriangleEntry{row, row + at} : TriangleEntry{at < D ? at : D, D};
}

/// Numbers that lie in lanes, as lanes: what is used is loaded where it is used. `in` is aligned as lanes are.
template <typename L>
inline const L* asLanes(const double* in) {
  return reinterpret_cast<const L*>(in);
}

/// Whether edges follow each other from a multiple of eight on, so that their constants lie as lanes do.
inline bool isRun(const std::int32_t* ids, int count) {
  std::int32_t differs = count > 0 ? ids[0] % 8 : 0;
  for (int i = 1; i < count; ++i) differs |= ids[i] ^ (ids[0] + i);
  return differs == 0;
}

/// The first Size of the `numbers` constants of eight edges, as lanes.
template <int Size, typename Isa>
inline void gatherConstants(const double* constants, int numbers, const std::int32_t* ids, Lanes<Isa>* out) {
  for (int i = 0; i < 8; ++i) {
    const double* in = constants + std::int64_t{ids[i] / 8} * numbers * 8 + ids[i] % 8;
    for (int k = 0; k < Size; ++k) out[k].v[i] = in[k * 8];
  }
}

}  // namespace quiver::detail
