// Included by lanes.h once an instruction set, with
//   QUIVER_LANES_ISA      the tag,
//   QUIVER_LANES_TARGET   the attribute every function carries,
//   QUIVER_LANES_NATIVE   doubles a register holds: 8, 4, or 1 for plain loops.
// Every function reads its operands from memory and writes its result there; inlined into a batch loop of the same
// target, memory becomes registers.

#if QUIVER_LANES_NATIVE == 8
#  define QUIVER_LANES_EACH(statement) \
    {                                  \
      constexpr int k = 0;             \
      statement;                       \
    }
#elif QUIVER_LANES_NATIVE == 4
#  define QUIVER_LANES_EACH(statement) \
    {                                  \
      constexpr int k = 0;             \
      statement;                       \
    }                                  \
    {                                  \
      constexpr int k = 1;             \
      statement;                       \
    }
#else
#  define QUIVER_LANES_EACH(statement) \
    for (int k = 0; k < 8; ++k) {      \
      statement;                       \
    }
#endif

#if QUIVER_LANES_NATIVE > 1
#  define QUIVER_LANES_TRUTH(comparison) ((Mask::Native)(comparison))
#else
#  define QUIVER_LANES_TRUTH(comparison) (-static_cast<std::int64_t>(comparison))
#endif

/// Eight truth values, all bits set for true. Not convertible to bool: ask any() or all().
template <>
class alignas(QUIVER_LANES_ALIGNMENT) LanesMask<QUIVER_LANES_ISA> {
 public:
#if QUIVER_LANES_NATIVE > 1
  typedef std::int64_t Native __attribute__((vector_size(8 * QUIVER_LANES_NATIVE), aligned(8), may_alias));
#else
  using Native = std::int64_t;
#endif
  std::int64_t v[8];

  LanesMask() = default;
  QUIVER_LANES_TARGET explicit inline LanesMask(bool truth) {
    const std::int64_t bits = -static_cast<std::int64_t>(truth);
    QUIVER_LANES_EACH(part(k) = bits - Native{});
  }
  /// Truth of one lane.
  bool operator[](int lane) const { return v[lane] != 0; }
  QUIVER_LANES_TARGET inline Native& part(int k) { return reinterpret_cast<Native*>(v)[k]; }
  QUIVER_LANES_TARGET inline const Native& part(int k) const { return reinterpret_cast<const Native*>(v)[k]; }
};

/// Eight doubles side by side.
template <>
class alignas(QUIVER_LANES_ALIGNMENT) Lanes<QUIVER_LANES_ISA> {
 public:
  using Mask = LanesMask<QUIVER_LANES_ISA>;
#if QUIVER_LANES_NATIVE > 1
  typedef double Native __attribute__((vector_size(8 * QUIVER_LANES_NATIVE), aligned(8), may_alias));
  typedef std::uint64_t Bits __attribute__((vector_size(8 * QUIVER_LANES_NATIVE), aligned(8), may_alias));
#elif defined(__GNUC__)
  using Native = double;
  typedef std::uint64_t Bits __attribute__((may_alias));
#else
  using Native = double;
  using Bits = std::uint64_t;
#endif
  static constexpr int width = 8;
  double v[8];

  Lanes() = default;
  /// The same number in every lane.
  QUIVER_LANES_TARGET inline Lanes(double s) { QUIVER_LANES_EACH(part(k) = s - Native{}); }
  QUIVER_LANES_TARGET inline Lanes& operator=(double s) {
    QUIVER_LANES_EACH(part(k) = s - Native{});
    return *this;
  }
  /// Eight consecutive doubles, of any alignment.
  QUIVER_LANES_TARGET static inline Lanes load(const double* from) {
    Lanes r;
    QUIVER_LANES_EACH(r.part(k) = reinterpret_cast<const Native*>(from)[k]);
    return r;
  }
  /// Writes eight consecutive doubles, of any alignment.
  QUIVER_LANES_TARGET inline void store(double* to) const {
    QUIVER_LANES_EACH(reinterpret_cast<Native*>(to)[k] = part(k));
  }
  double& operator[](int lane) { return v[lane]; }
  double operator[](int lane) const { return v[lane]; }

  QUIVER_LANES_TARGET inline Native& part(int k) { return reinterpret_cast<Native*>(v)[k]; }
  QUIVER_LANES_TARGET inline const Native& part(int k) const { return reinterpret_cast<const Native*>(v)[k]; }
  QUIVER_LANES_TARGET inline Bits& bits(int k) { return reinterpret_cast<Bits*>(v)[k]; }
  QUIVER_LANES_TARGET inline const Bits& bits(int k) const { return reinterpret_cast<const Bits*>(v)[k]; }
};

#define QUIVER_L Lanes<QUIVER_LANES_ISA>
#define QUIVER_M LanesMask<QUIVER_LANES_ISA>

#define QUIVER_LANES_OPERATOR(op)                                                         \
  QUIVER_LANES_TARGET inline QUIVER_L operator op(const QUIVER_L& a, const QUIVER_L& b) { \
    QUIVER_L r;                                                                           \
    QUIVER_LANES_EACH(r.part(k) = a.part(k) op b.part(k));                                \
    return r;                                                                             \
  }                                                                                       \
  QUIVER_LANES_TARGET inline QUIVER_L& operator op##=(QUIVER_L& a, const QUIVER_L& b) {   \
    QUIVER_LANES_EACH(a.part(k) = a.part(k) op b.part(k));                                \
    return a;                                                                             \
  }
QUIVER_LANES_OPERATOR(+)
QUIVER_LANES_OPERATOR(-)
QUIVER_LANES_OPERATOR(*)
QUIVER_LANES_OPERATOR(/)
#undef QUIVER_LANES_OPERATOR

#define QUIVER_LANES_COMPARISON(op)                                                       \
  QUIVER_LANES_TARGET inline QUIVER_M operator op(const QUIVER_L& a, const QUIVER_L& b) { \
    using Mask = QUIVER_M;                                                                \
    Mask r;                                                                               \
    QUIVER_LANES_EACH(r.part(k) = QUIVER_LANES_TRUTH(a.part(k) op b.part(k)));            \
    return r;                                                                             \
  }
QUIVER_LANES_COMPARISON(<)
QUIVER_LANES_COMPARISON(<=)
QUIVER_LANES_COMPARISON(>)
QUIVER_LANES_COMPARISON(>=)
QUIVER_LANES_COMPARISON(==)
QUIVER_LANES_COMPARISON(!=)
#undef QUIVER_LANES_COMPARISON

#define QUIVER_LANES_LOGIC(op, bitwise)                                                   \
  QUIVER_LANES_TARGET inline QUIVER_M operator op(const QUIVER_M& a, const QUIVER_M& b) { \
    QUIVER_M r;                                                                           \
    QUIVER_LANES_EACH(r.part(k) = a.part(k) bitwise b.part(k));                           \
    return r;                                                                             \
  }
QUIVER_LANES_LOGIC(&&, &)
QUIVER_LANES_LOGIC(&, &)
QUIVER_LANES_LOGIC(||, |)
QUIVER_LANES_LOGIC(|, |)
QUIVER_LANES_LOGIC(^, ^)
#undef QUIVER_LANES_LOGIC

QUIVER_LANES_TARGET inline QUIVER_M operator!(const QUIVER_M& a) {
  QUIVER_M r;
  QUIVER_LANES_EACH(r.part(k) = ~a.part(k));
  return r;
}

QUIVER_LANES_TARGET inline QUIVER_L operator+(const QUIVER_L& a) { return a; }

QUIVER_LANES_TARGET inline QUIVER_L operator-(const QUIVER_L& a) {
  QUIVER_L r;
  QUIVER_LANES_EACH(r.part(k) = -a.part(k));
  return r;
}

/// Lane by lane: a where the mask is true, b elsewhere.
QUIVER_LANES_TARGET inline QUIVER_L select(const QUIVER_M& mask, const QUIVER_L& a, const QUIVER_L& b) {
  QUIVER_L r;
  QUIVER_LANES_EACH(r.part(k) = mask.part(k) ? a.part(k) : b.part(k));
  return r;
}

QUIVER_LANES_TARGET inline bool any(const QUIVER_M& mask) {
#if QUIVER_LANES_NATIVE == 8
  return __builtin_ia32_cvtq2mask512(reinterpret_cast<detail::EightBits>(mask.part(0))) != 0;
#elif QUIVER_LANES_NATIVE == 4
  return __builtin_ia32_movmskpd256(reinterpret_cast<detail::Four>(mask.part(0) | mask.part(1))) != 0;
#else
  std::int64_t r = 0;
  for (int k = 0; k < 8; ++k) r |= mask.v[k];
  return r != 0;
#endif
}

QUIVER_LANES_TARGET inline bool all(const QUIVER_M& mask) { return !any(!mask); }

QUIVER_LANES_TARGET inline QUIVER_L sqrt(const QUIVER_L& a) {
  QUIVER_L r;
#if QUIVER_LANES_NATIVE == 8
  QUIVER_LANES_EACH(r.part(k) =
                        __builtin_ia32_sqrtpd512_mask(a.part(k), detail::Eight{}, 0xff, detail::asRoundingIsSet));
#elif QUIVER_LANES_NATIVE == 4
  QUIVER_LANES_EACH(r.part(k) = __builtin_ia32_sqrtpd256(a.part(k)));
#else
  QUIVER_LANES_EACH(r.part(k) = std::sqrt(a.part(k)));
#endif
  return r;
}

/// a b + c, rounded once.
QUIVER_LANES_TARGET inline QUIVER_L fma(const QUIVER_L& a, const QUIVER_L& b, const QUIVER_L& c) {
  QUIVER_L r;
#if QUIVER_LANES_NATIVE == 8
  QUIVER_LANES_EACH(
      r.part(k) = __builtin_ia32_vfmaddpd512_mask(a.part(k), b.part(k), c.part(k), 0xff, detail::asRoundingIsSet));
#elif QUIVER_LANES_NATIVE == 4
  QUIVER_LANES_EACH(r.part(k) = __builtin_ia32_vfmaddpd256(a.part(k), b.part(k), c.part(k)));
#else
  QUIVER_LANES_EACH(r.part(k) = std::fma(a.part(k), b.part(k), c.part(k)));
#endif
  return r;
}

/// The nearest integer, halves to even.
QUIVER_LANES_TARGET inline QUIVER_L rint(const QUIVER_L& a) {
  QUIVER_L r;
#if QUIVER_LANES_NATIVE == 8
  QUIVER_LANES_EACH(r.part(k) = __builtin_ia32_rndscalepd_mask(a.part(k), detail::toNearest, detail::Eight{}, 0xff,
                                                               detail::asRoundingIsSet));
#elif QUIVER_LANES_NATIVE == 4
  QUIVER_LANES_EACH(r.part(k) = __builtin_ia32_roundpd256(a.part(k), detail::toNearest));
#else
  QUIVER_LANES_EACH(r.part(k) = std::rint(a.part(k)));
#endif
  return r;
}

QUIVER_LANES_TARGET inline QUIVER_L floor(const QUIVER_L& a) {
  QUIVER_L r;
#if QUIVER_LANES_NATIVE == 8
  QUIVER_LANES_EACH(r.part(k) = __builtin_ia32_rndscalepd_mask(a.part(k), detail::down, detail::Eight{}, 0xff,
                                                               detail::asRoundingIsSet));
#elif QUIVER_LANES_NATIVE == 4
  QUIVER_LANES_EACH(r.part(k) = __builtin_ia32_roundpd256(a.part(k), detail::down));
#else
  QUIVER_LANES_EACH(r.part(k) = std::floor(a.part(k)));
#endif
  return r;
}

QUIVER_LANES_TARGET inline QUIVER_L min(const QUIVER_L& a, const QUIVER_L& b) {
  QUIVER_L r;
  QUIVER_LANES_EACH(r.part(k) = b.part(k) < a.part(k) ? b.part(k) : a.part(k));
  return r;
}

QUIVER_LANES_TARGET inline QUIVER_L max(const QUIVER_L& a, const QUIVER_L& b) {
  QUIVER_L r;
  QUIVER_LANES_EACH(r.part(k) = a.part(k) < b.part(k) ? b.part(k) : a.part(k));
  return r;
}

QUIVER_LANES_TARGET inline QUIVER_L abs(const QUIVER_L& a) {
  QUIVER_L r;
  QUIVER_LANES_EACH(r.bits(k) = a.bits(k) & 0x7fff'ffff'ffff'ffffU);
  return r;
}

/// |magnitude| with the sign bit of `sign`.
QUIVER_LANES_TARGET inline QUIVER_L copysign(const QUIVER_L& magnitude, const QUIVER_L& sign) {
  QUIVER_L r;
  QUIVER_LANES_EACH(r.bits(k) = (magnitude.bits(k) & 0x7fff'ffff'ffff'ffffU) | (sign.bits(k) & 0x8000'0000'0000'0000U));
  return r;
}

/// True where a lane is neither infinite nor a NaN; looks at bits, so it holds in loops that assume finite numbers.
QUIVER_LANES_TARGET inline QUIVER_M isfinite(const QUIVER_L& a) {
  using Mask = QUIVER_M;
  Mask r;
  QUIVER_LANES_EACH(r.part(k) = QUIVER_LANES_TRUTH((a.bits(k) & 0x7ff0'0000'0000'0000U) != 0x7ff0'0000'0000'0000U));
  return r;
}

namespace detail {

/// x 2^n for integral n in [-1022, 1023].
QUIVER_LANES_TARGET inline QUIVER_L scaleByPowerOfTwo(const QUIVER_L& x, const QUIVER_L& n) {
  QUIVER_L r = n + QUIVER_L(6755399441055744.0);  // 1.5 * 2^52: the integer n now fills the low bits
  QUIVER_LANES_EACH(r.bits(k) = (r.bits(k) + 1023U) << 52);
  return x * r;
}

/// True where bit `position` (0 or 1) of the two's complement integer n, |n| < 2^51, is set.
QUIVER_LANES_TARGET inline QUIVER_M bitOf(const QUIVER_L& n, int position) {
  using Mask = QUIVER_M;
  Mask r;
  const QUIVER_L shifted = n + QUIVER_L(6755399441055744.0);
  QUIVER_LANES_EACH(r.part(k) = QUIVER_LANES_TRUTH(((shifted.bits(k) >> position) & 1U) != 0U));
  return r;
}

/// True where a lane is a positive normal number.
QUIVER_LANES_TARGET inline QUIVER_M isPositiveNormal(const QUIVER_L& a) {
  using Mask = QUIVER_M;
  Mask r;
  QUIVER_LANES_EACH(r.part(k) = QUIVER_LANES_TRUTH(a.bits(k) - 0x0010'0000'0000'0000U < 0x7fe0'0000'0000'0000U));
  return r;
}

/// Splits positive normal x = m 2^e with m in [sqrt(1/2), sqrt(2)).
QUIVER_LANES_TARGET inline void splitExponent(const QUIVER_L& x, QUIVER_L& m, QUIVER_L& e) {
  QUIVER_L biased;
  QUIVER_LANES_EACH(biased.bits(k) = (x.bits(k) + (0x4000'0000'0000'0000U - 0x3fe6'a09e'667f'3bcdU)) >> 52);
  QUIVER_LANES_EACH(m.bits(k) = x.bits(k) - ((biased.bits(k) - 1024U) << 52));
  QUIVER_LANES_EACH(biased.bits(k) = biased.bits(k) | 0x4330'0000'0000'0000U);  // the integer plus 2^52
  e = biased - QUIVER_L(4503599627370496.0 + 1024.0);
}

}  // namespace detail

#undef QUIVER_L
#undef QUIVER_M
#undef QUIVER_LANES_EACH
#undef QUIVER_LANES_TRUTH
#undef QUIVER_LANES_ISA
#undef QUIVER_LANES_TARGET
#undef QUIVER_LANES_NATIVE
