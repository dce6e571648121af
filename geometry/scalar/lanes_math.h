#pragma once

/// \file
/// Elementary functions of `Lanes`: polynomials within 2 ulp of the true value (tan, asin, acos within 4), checked
/// against libm. Arguments outside a polynomial's range (trigonometric functions beyond 1e5, logarithms of anything but
/// positive normal numbers) go to libm lane by lane, in a cold function.

#include <quiver/geometry/scalar/lanes.h>

namespace quiver {

/// Sine and cosine of one angle.
template <class S>
struct SinCos {
  S sine;
  S cosine;
};

/// Sine and cosine of x [rad].
inline SinCos<double> sincos(double x) { return {std::sin(x), std::cos(x)}; }

namespace detail {

/// c[0] + c[1] z + ... by Horner's rule with one rounding a step.
template <class T, class... Rest>
inline T horner(const T& z, double first, Rest... rest) {
  if constexpr (sizeof...(rest) == 0) {
    return T(first);
  } else {
    return fma(horner(z, rest...), z, T(first));
  }
}

QUIVER_COLD inline void sincosEach(const double* x, double* sine, double* cosine) {
  for (int i = 0; i < 8; ++i) {
    sine[i] = std::sin(x[i]);
    cosine[i] = std::cos(x[i]);
  }
}
QUIVER_COLD inline void logEach(const double* x, double* y) {
  for (int i = 0; i < 8; ++i) y[i] = std::log(x[i]);
}

}  // namespace detail

template <class Isa>
inline SinCos<Lanes<Isa>> sincos(const Lanes<Isa>& x) {
  using L = Lanes<Isa>;
  // x = n pi/2 + r. The first product cancels exactly while |n| < 2^20; the constants are pi/2 in three parts.
  const L n = rint(x * L(0x1.45f306dc9c883p-1));
  L r = fma(n, L(-0x1.921fb54442d18p+0), x);
  r = fma(n, L(-0x1.1a62633145c07p-54), r);
  r = fma(n, L(0x1.f1976b7ed8fbcp-110), r);
  const L z = r * r;
  const L sinTail = detail::horner(z, -0.16666666666666666, 0.008333333333330927, -0.00019841269836724877,
                                   2.7557316084930363e-06, -2.50511281499847e-08, 1.5917861853805866e-10);
  const L cosTail = detail::horner(z, 0.041666666666666664, -0.0013888888888887382, 2.4801587298744435e-05,
                                   -2.755731726062817e-07, 2.0876143942503467e-09, -1.1382464188417552e-11);
  const L s = fma(r * z, sinTail, r);
  const L half = L(0.5) * z;
  const L top = L(1.0) - half;
  const L c = top + fma(z * z, cosTail, (L(1.0) - top) - half);
  const auto odd = detail::bitOf(n, 0);
  const auto negative = detail::bitOf(n, 1);
  const L sine = select(odd, c, s);
  const L cosine = select(odd, s, c);
  SinCos<L> result{select(negative, -sine, sine), select(negative ^ odd, -cosine, cosine)};
  const auto far = !(abs(x) <= L(1e5));
  if (any(far || !isfinite(x))) [[unlikely]] {
    double in[8], farSine[8], farCosine[8];
    x.store(in);
    detail::sincosEach(in, farSine, farCosine);
    result = {L::load(farSine), L::load(farCosine)};
  }
  return result;
}

template <class Isa>
inline Lanes<Isa> sin(const Lanes<Isa>& x) {
  return sincos(x).sine;
}

template <class Isa>
inline Lanes<Isa> cos(const Lanes<Isa>& x) {
  return sincos(x).cosine;
}

template <class Isa>
inline Lanes<Isa> tan(const Lanes<Isa>& x) {
  const auto both = sincos(x);
  return both.sine / both.cosine;
}

/// The angle of (x, y) in [-pi, pi]; 0 at the origin (pi when x is -0), as std::atan2.
template <class Isa>
inline Lanes<Isa> atan2(const Lanes<Isa>& y, const Lanes<Isa>& x) {
  using L = Lanes<Isa>;
  const L ax = abs(x), ay = abs(y);
  const L small = min(ax, ay), large = max(ax, ay);
  // Beyond tan(pi/8) turn by pi/4: atan(s/l) = pi/4 + atan((s - l)/(s + l)).
  const auto turn = small > large * L(0.41421356237309503);
  const L numerator = select(turn, small - large, small);
  const L denominator = select(turn, small + large, large);
  const L t = select(large > L(0.0), numerator / denominator, L(0.0));
  const L z = t * t;
  const L tail = detail::horner(z, -0.3333333333333333, 0.199999999999957, -0.14285714284699214, 0.11111111017576371,
                                -0.09090904661647067, 0.07692184914411312, -0.06664533048837482, 0.05858316011700457,
                                -0.05086228427125592, 0.03925167689547228, -0.019198670421054633);
  // angle = offset +- a where the offset (0, pi/4, pi/2, ...) comes in two parts, high and low.
  L a = fma(t * z, tail, t);
  L units = select(turn, L(1.0), L(0.0));
  const auto steep = ay > ax;
  a = select(steep, -a, a);
  units = select(steep, L(2.0) - units, units);
  const auto behind = copysign(L(1.0), x) < L(0.0);
  a = select(behind, -a, a);
  units = select(behind, L(4.0) - units, units);
  const L angle = fma(units, L(0x1.921fb54442d18p-1), fma(units, L(0x1.1a62633145c07p-55), a));
  return copysign(angle, y);
}

template <class Isa>
inline Lanes<Isa> atan(const Lanes<Isa>& x) {
  return atan2(x, Lanes<Isa>(1.0));
}

template <class Isa>
inline Lanes<Isa> asin(const Lanes<Isa>& x) {
  using L = Lanes<Isa>;
  return atan2(x, sqrt((L(1.0) - x) * (L(1.0) + x)));
}

template <class Isa>
inline Lanes<Isa> acos(const Lanes<Isa>& x) {
  using L = Lanes<Isa>;
  return atan2(sqrt((L(1.0) - x) * (L(1.0) + x)), x);
}

template <class Isa>
inline Lanes<Isa> exp(const Lanes<Isa>& x) {
  using L = Lanes<Isa>;
  const L clamped = max(min(x, L(710.0)), L(-746.0));  // beyond: infinity, zero
  const L n = rint(clamped * L(0x1.71547652b82fep+0));
  L r = fma(n, L(-0x1.62e42fee00000p-1), clamped);
  r = fma(n, L(-0x1.a39ef35793c76p-33), r);
  const L tail = detail::horner(r, 0.5000000000000001, 0.16666666666666674, 0.04166666666662381, 0.008333333333322127,
                                0.0013888888917370768, 0.00019841269886836392, 2.4801521052948772e-05,
                                2.7557242059340425e-06, 2.7620203638894305e-07, 2.5110154340462048e-08);
  const L mantissa = L(1.0) + fma(r * r, tail, r);
  const L half = floor(n * L(0.5));  // two factors, each a normal number
  return detail::scaleByPowerOfTwo(detail::scaleByPowerOfTwo(mantissa, half), n - half);
}

/// The natural logarithm: -infinity at 0, NaN below.
template <class Isa>
inline Lanes<Isa> log(const Lanes<Isa>& x) {
  using L = Lanes<Isa>;
  L m, e;
  detail::splitExponent(x, m, e);
  const L f = m - L(1.0);
  const L s = f / (L(2.0) + f);
  const L z = s * s;
  const L tail = z * detail::horner(z, 0.666666666666667, 0.3999999999989726, 0.28571428626933176, 0.22222210985907984,
                                    0.18182899537145011, 0.1533138741398948, 0.14620457272358992);
  // log(1 + f) = f - f^2/2 + s (f^2/2 + tail)
  const L half = L(0.5) * f * f;
  const L low = fma(s, half + tail, e * L(0x1.a39ef35793c76p-33));
  L result = fma(e, L(0x1.62e42fee00000p-1), f - (half - low));
  if (!all(detail::isPositiveNormal(x))) [[unlikely]] {
    double in[8], out[8];
    x.store(in);
    detail::logEach(in, out);
    result = L::load(out);
  }
  return result;
}

}  // namespace quiver
