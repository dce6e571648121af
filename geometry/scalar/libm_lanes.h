#pragma once

/// \file
/// Elementary functions of `Lanes` by libm, lane by lane: as exact as libm, about as slow as eight calls.

#include <quiver/geometry/scalar/lanes.h>
#include <cmath>
#include <type_traits>

namespace quiver {

namespace detail {

QUIVER_COLD inline void eachLane(double (*function)(double), const double* x, double* y) {
  for (int i = 0; i < 8; ++i) y[i] = function(x[i]);
}
QUIVER_COLD inline void eachLane(double (*function)(double, double), const double* a, const double* b, double* y) {
  for (int i = 0; i < 8; ++i) y[i] = function(a[i], b[i]);
}

template <class Isa>
inline Lanes<Isa> byLibm(double (*function)(double), const Lanes<Isa>& x) {
  double in[8], out[8];
  x.store(in);
  eachLane(function, in, out);
  return Lanes<Isa>::load(out);
}
template <class Isa>
inline Lanes<Isa> byLibm(double (*function)(double, double), const Lanes<Isa>& a, const Lanes<Isa>& b) {
  double first[8], second[8], out[8];
  a.store(first);
  b.store(second);
  eachLane(function, first, second, out);
  return Lanes<Isa>::load(out);
}

}  // namespace detail

/// x to the power y. For squares and cubes multiply.
template <class Isa>
inline Lanes<Isa> pow(const Lanes<Isa>& x, const std::type_identity_t<Lanes<Isa>>& y) {
  return detail::byLibm(std::pow, x, y);
}
template <class Isa>
inline Lanes<Isa> pow(double base, const Lanes<Isa>& y) {
  return detail::byLibm(std::pow, Lanes<Isa>(base), y);
}
template <class Isa>
inline Lanes<Isa> hypot(const Lanes<Isa>& x, const std::type_identity_t<Lanes<Isa>>& y) {
  return detail::byLibm(std::hypot, x, y);
}
template <class Isa>
inline Lanes<Isa> cbrt(const Lanes<Isa>& x) {
  return detail::byLibm(std::cbrt, x);
}
template <class Isa>
inline Lanes<Isa> sinh(const Lanes<Isa>& x) {
  return detail::byLibm(std::sinh, x);
}
template <class Isa>
inline Lanes<Isa> cosh(const Lanes<Isa>& x) {
  return detail::byLibm(std::cosh, x);
}
template <class Isa>
inline Lanes<Isa> tanh(const Lanes<Isa>& x) {
  return detail::byLibm(std::tanh, x);
}
/// e^x - 1, exact near 0.
template <class Isa>
inline Lanes<Isa> expm1(const Lanes<Isa>& x) {
  return detail::byLibm(std::expm1, x);
}
/// log(1 + x), exact near 0.
template <class Isa>
inline Lanes<Isa> log1p(const Lanes<Isa>& x) {
  return detail::byLibm(std::log1p, x);
}
template <class Isa>
inline Lanes<Isa> log2(const Lanes<Isa>& x) {
  return detail::byLibm(std::log2, x);
}
template <class Isa>
inline Lanes<Isa> log10(const Lanes<Isa>& x) {
  return detail::byLibm(std::log10, x);
}
/// The error function.
template <class Isa>
inline Lanes<Isa> erf(const Lanes<Isa>& x) {
  return detail::byLibm(std::erf, x);
}

}  // namespace quiver
