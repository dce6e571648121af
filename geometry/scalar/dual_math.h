#pragma once

/// \file
/// Elementary functions of dual numbers, over double and over lanes.
///
/// Where the true derivative is infinite or undefined the gradient is zero instead of NaN, so that one degenerate
/// measurement does not poison a system: sqrt and cbrt at 0 (hence norm() of a zero vector has gradient zero), atan2
/// and hypot at (0, 0), asin and acos at +-1, abs at 0 (slope +1).

#include <quiver/geometry/scalar/dual.h>
#include <quiver/geometry/scalar/lanes_math.h>
#include <quiver/geometry/scalar/libm_lanes.h>
#include <cmath>

namespace quiver {

namespace detail {
/// numerator / denominator, and 0 where the denominator is 0.
template <class T>
inline T quotientOrZero(const T& numerator, const T& denominator) {
  const auto usable = abs(denominator) > T(0.0);
  return select(usable, numerator / select(usable, denominator, T(1.0)), T(0.0));
}
inline double quotientOrZero(double numerator, double denominator) {
  return denominator != 0.0 ? numerator / denominator : 0.0;
}
}  // namespace detail

template <class T, int N>
inline Dual<T, N> sqrt(const Dual<T, N>& x) {
  using std::sqrt;
  const T root = sqrt(x.value);
  return x.scaled(root, detail::quotientOrZero(T(0.5), root));
}

template <class T, int N>
inline Dual<T, N> abs(const Dual<T, N>& x) {
  return select(x.value < T(0.0), -x, x);
}

template <class T, int N>
inline SinCos<Dual<T, N>> sincos(const Dual<T, N>& x) {
  const SinCos<T> both = sincos(x.value);
  return {x.scaled(both.sine, both.cosine), x.scaled(both.cosine, -both.sine)};
}

template <class T, int N>
inline Dual<T, N> sin(const Dual<T, N>& x) {
  return sincos(x).sine;
}

template <class T, int N>
inline Dual<T, N> cos(const Dual<T, N>& x) {
  return sincos(x).cosine;
}

template <class T, int N>
inline Dual<T, N> tan(const Dual<T, N>& x) {
  using std::tan;
  const T t = tan(x.value);
  return x.scaled(t, T(1.0) + t * t);
}

template <class T, int N>
inline Dual<T, N> atan2(const Dual<T, N>& y, const Dual<T, N>& x) {
  using std::atan2;
  const T squared = x.value * x.value + y.value * y.value;
  const T alongY = detail::quotientOrZero(x.value, squared);
  const T alongX = detail::quotientOrZero(-y.value, squared);
  Dual<T, N> r;
  r.value = atan2(y.value, x.value);
  QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = alongY * y.gradient[i] + alongX * x.gradient[i];
  return r;
}

template <class T, int N>
inline Dual<T, N> atan(const Dual<T, N>& x) {
  using std::atan;
  return x.scaled(atan(x.value), T(1.0) / (T(1.0) + x.value * x.value));
}

template <class T, int N>
inline Dual<T, N> asin(const Dual<T, N>& x) {
  using std::asin, std::sqrt;
  return x.scaled(asin(x.value), detail::quotientOrZero(T(1.0), sqrt((T(1.0) - x.value) * (T(1.0) + x.value))));
}

template <class T, int N>
inline Dual<T, N> acos(const Dual<T, N>& x) {
  using std::acos, std::sqrt;
  return x.scaled(acos(x.value), detail::quotientOrZero(T(-1.0), sqrt((T(1.0) - x.value) * (T(1.0) + x.value))));
}

template <class T, int N>
inline Dual<T, N> exp(const Dual<T, N>& x) {
  using std::exp;
  const T e = exp(x.value);
  return x.scaled(e, e);
}

template <class T, int N>
inline Dual<T, N> log(const Dual<T, N>& x) {
  using std::log;
  return x.scaled(log(x.value), T(1.0) / x.value);
}

namespace detail {
/// The slope of x^e along x, e x^(e−1), where p = x^e; 0 at x = 0 unless e is 1.
template <class T>
inline T powerSlope(const T& x, const T& e, const T& p) {
  const auto other = abs(e - T(1.0)) > T(0.0);
  return select(other, quotientOrZero(e * p, x), T(1.0));
}
inline double powerSlope(double x, double e, double p) { return e == 1.0 ? 1.0 : quotientOrZero(e * p, x); }
}  // namespace detail

/// x to a constant power; the gradient at x = 0 is 0 but for the power 1.
template <class T, int N>
inline Dual<T, N> pow(const Dual<T, N>& x, double exponent) {
  using std::pow;
  const T p = pow(x.value, exponent);
  return x.scaled(p, detail::powerSlope(x.value, T(exponent), p));
}

/// x to a power; where x is not positive, the gradient along the exponent, which does not exist there, is 0.
template <class T, int N>
inline Dual<T, N> pow(const Dual<T, N>& x, const Dual<T, N>& exponent) {
  using std::log, std::pow;
  const T p = pow(x.value, exponent.value);
  const auto positive = x.value > T(0.0);
  const T alongBase = detail::powerSlope(x.value, exponent.value, p);
  const T alongExponent = select(positive, p * log(select(positive, x.value, T(1.0))), T(0.0));
  Dual<T, N> r;
  r.value = p;
  QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] =
      alongBase * x.gradient[i] + alongExponent * exponent.gradient[i];
  return r;
}

/// A constant to a power.
template <class T, int N, detail::ConstantOf<T> U>
inline Dual<T, N> pow(const U& base, const Dual<T, N>& exponent) {
  using std::log, std::pow;
  const T p = pow(T(base), exponent.value);
  return exponent.scaled(p, p * log(T(base)));
}

template <class T, int N>
inline Dual<T, N> hypot(const Dual<T, N>& x, const Dual<T, N>& y) {
  using std::hypot;
  const T length = hypot(x.value, y.value);
  const T alongX = detail::quotientOrZero(x.value, length);
  const T alongY = detail::quotientOrZero(y.value, length);
  Dual<T, N> r;
  r.value = length;
  QUIVER_UNROLL for (int i = 0; i < N; ++i) r.gradient[i] = alongX * x.gradient[i] + alongY * y.gradient[i];
  return r;
}

template <class T, int N, detail::ConstantOf<T> U>
inline Dual<T, N> hypot(const Dual<T, N>& x, const U& y) {
  return hypot(x, Dual<T, N>(y));
}
template <class T, int N, detail::ConstantOf<T> U>
inline Dual<T, N> hypot(const U& x, const Dual<T, N>& y) {
  return hypot(Dual<T, N>(x), y);
}

template <class T, int N>
inline Dual<T, N> cbrt(const Dual<T, N>& x) {
  using std::cbrt;
  const T root = cbrt(x.value);
  return x.scaled(root, detail::quotientOrZero(T(1.0 / 3.0), root * root));
}

template <class T, int N>
inline Dual<T, N> sinh(const Dual<T, N>& x) {
  using std::cosh, std::sinh;
  return x.scaled(sinh(x.value), cosh(x.value));
}

template <class T, int N>
inline Dual<T, N> cosh(const Dual<T, N>& x) {
  using std::cosh, std::sinh;
  return x.scaled(cosh(x.value), sinh(x.value));
}

template <class T, int N>
inline Dual<T, N> tanh(const Dual<T, N>& x) {
  using std::tanh;
  const T t = tanh(x.value);
  return x.scaled(t, (T(1.0) - t) * (T(1.0) + t));
}

template <class T, int N>
inline Dual<T, N> expm1(const Dual<T, N>& x) {
  using std::exp, std::expm1;
  return x.scaled(expm1(x.value), exp(x.value));
}

template <class T, int N>
inline Dual<T, N> log1p(const Dual<T, N>& x) {
  using std::log1p;
  return x.scaled(log1p(x.value), T(1.0) / (T(1.0) + x.value));
}

template <class T, int N>
inline Dual<T, N> log2(const Dual<T, N>& x) {
  using std::log2;
  constexpr double ln2 = 0.69314718055994531;
  return x.scaled(log2(x.value), T(1.0 / ln2) / x.value);
}

template <class T, int N>
inline Dual<T, N> log10(const Dual<T, N>& x) {
  using std::log10;
  constexpr double ln10 = 2.302585092994046;
  return x.scaled(log10(x.value), T(1.0 / ln10) / x.value);
}

template <class T, int N>
inline Dual<T, N> erf(const Dual<T, N>& x) {
  using std::erf, std::exp;
  constexpr double twoOverRootPi = 1.1283791670955126;
  return x.scaled(erf(x.value), T(twoOverRootPi) * exp(-x.value * x.value));
}

template <class T, int N>
inline Dual<T, N> fma(const Dual<T, N>& a, const Dual<T, N>& b, const Dual<T, N>& c) {
  return a * b + c;
}

/// |magnitude| with the sign of the value of `sign`, which is held constant.
template <class T, int N>
inline Dual<T, N> copysign(const Dual<T, N>& magnitude, const Dual<T, N>& sign) {
  using std::copysign;
  const T one = copysign(T(1.0), sign.value);
  return abs(magnitude) * one;
}

/// Steps: derivatives are zero.
template <class T, int N>
inline Dual<T, N> floor(const Dual<T, N>& x) {
  using std::floor;
  return Dual<T, N>(floor(x.value));
}

template <class T, int N>
inline Dual<T, N> rint(const Dual<T, N>& x) {
  using std::rint;
  return Dual<T, N>(rint(x.value));
}

/// Whether the value and every derivative are finite.
template <class T, int N>
inline auto isfinite(const Dual<T, N>& x) {
  using std::isfinite;
  MaskOf<T> all = isfinite(x.value);
  QUIVER_UNROLL for (int i = 0; i < N; ++i) all = all && isfinite(x.gradient[i]);
  return all;
}

}  // namespace quiver
