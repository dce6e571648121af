#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include <quiver/geometry/linear.h>
#include <quiver/geometry/packing.h>

namespace quiver::detail {

inline constexpr double differenceStep = 6.055454452393343e-06;  // cube root of the double's epsilon

/// A first step for a coordinate of that size: ε^⅓ times the cube root of the size, at least 1. Of a coordinate x the
/// error's rounding is ε|x|, so that (ε|x|)^⅓ loses least where the error bends over lengths of about 1, however far
/// away the world's origin is (UTM coordinates, say). Never so short that it would vanish in the coordinate, and a
/// power of two, so that adding it rounds as little as can be.
inline double differenceStepOf(double size) {
  constexpr double roundings = 64.0 * std::numeric_limits<double>::epsilon();
  const double step = std::max(differenceStep * std::cbrt(std::max(1.0, size)), roundings * size);
  return std::isfinite(step) ? std::ldexp(1.0, std::ilogb(step)) : differenceStep;
}

/// The largest number of an estimate of any type among those that one direction of its tangent moves.
template <typename Vertex, typename Estimate>
inline double sizeMoved(const Estimate& x, int direction) {
  constexpr double noticeable = 1e-8;  // of the largest number
  std::array<double, static_cast<std::size_t>(Packing<Estimate>::size)> before{};
  auto after = before;
  Packing<Estimate>::store(x, before.data());
  double largest = 1.0;
  for (const double number : before) largest = std::max(largest, std::abs(number));
  Vector<double, Vertex::dimension> delta = Vector<double, Vertex::dimension>::Zero();
  delta[direction] = std::max(differenceStep, noticeable * largest);
  Packing<Estimate>::store(Vertex::oplus(x, delta), after.data());
  double size = 0.0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (after[k] != before[k]) size = std::max(size, std::abs(before[k]));
  }
  return size;
}

/// The first step of a central difference along one direction of a vertex's tangent, by what it moves.
template <typename Vertex, typename Estimate>
inline double firstDifferenceStep(const Estimate& x, int direction) {
  if constexpr (std::is_same_v<Estimate, double>) {
    return differenceStepOf(std::abs(x));
  } else if constexpr (requires { x.translation(); }) {
    // Translation comes first in every tangent; it moves in metres, rotation and scale in radians and logarithms.
    return differenceStepOf(direction < x.translation().size() ? x.translation().cwiseAbs().maxCoeff() : 1.0);
  } else if constexpr (requires {
                         x.size();
                         x[0];
                       }) {
    return differenceStepOf(direction < x.size() ? std::abs(x[direction]) : 1.0);
  } else if constexpr (Vertex::dimension > 0 && requires { Packing<Estimate>::size; }) {
    return differenceStepOf(sizeMoved<Vertex>(x, direction));
  } else {
    return differenceStepOf(1.0);
  }
}

/// Slopes of an error by one central difference, and how far they may be off, row by row, relative to themselves: by
/// bending within the step, and by rounding.
template <typename Error>
struct CentralDifference {
  Error slope;
  Error bending;
  Error rounding;

  template <typename ErrorAt>
  CentralDifference(double step, const Error& error, const ErrorAt& errorAt) : slope(error) {
    const Error forward = errorAt(step);
    const Error backward = errorAt(-step);
    slope = (forward - backward) / (2.0 * step);
    bending = rounding = slope;
    for (int r = 0; r < slope.size(); ++r) judge(r, error[r], forward[r], backward[r]);
  }
  /// How far row r may be off in all.
  double doubt(int r) const { return bending[r] + rounding[r]; }
  bool bends() const { return !((bending.array() <= 1e-8).all()); }
  bool rounds() const { return !((rounding.array() <= 1e-6).all()); }

 private:
  /// Along a line of curvature 1/L the second difference is h/2L of the first, and (h/L)²/6 the error of the slope.
  void judge(int r, double middle, double forward, double backward) {
    constexpr double epsilon = std::numeric_limits<double>::epsilon();
    const double rise = std::abs(forward - backward);
    const double bend = std::abs((forward - middle) - (middle - backward));
    const double noise = 4.0 * epsilon * (std::abs(forward) + std::abs(backward));
    bending[r] = rounding[r] = 0.0;
    if (!std::isfinite(rise) || !std::isfinite(bend)) {
      bending[r] = std::numeric_limits<double>::infinity();
    } else if (rise > 0.0 || bend > noise) {
      const double ratio = bend > 2.0 * noise ? bend / rise : 0.0;
      bending[r] = ratio * ratio;
      rounding[r] = noise / std::max(rise, std::numeric_limits<double>::min());
    }
  }
};

/// Takes over the rows of `next` that are less in doubt and agree with `before` (the step tried last); whether any was.
template <typename Error>
inline bool takeBetterRows(const CentralDifference<Error>& next, const CentralDifference<Error>& before,
                           CentralDifference<Error>& best) {
  constexpr double agreement = 1e-2;
  constexpr double doubts = 10.0, always = 1e-6;
  bool any = false;
  for (int r = 0; r < next.slope.size(); ++r) {
    // No slope at all is what steps below the rounding of the estimate give.
    if (next.slope[r] == 0.0 || !(next.doubt(r) < best.doubt(r))) continue;
    // Roundings that constants of the error hide show themselves here.
    const double apart = std::min(agreement, doubts * before.doubt(r) + always);
    if (!(std::abs(next.slope[r] - before.slope[r]) <= apart * std::abs(next.slope[r]))) continue;
    best.slope[r] = next.slope[r];
    best.bending[r] = next.bending[r];
    best.rounding[r] = next.rounding[r];
    any = true;
  }
  return any;
}

/// Column of a Jacobian by central differences of `errorAt(step)`, `error` being errorAt(0).
///
/// The second difference, which costs nothing, tells whether the error bends within the step, as it does along a
/// coordinate whose own size is 1e-7 (a distortion in pixels⁻², a rate in nanoseconds⁻¹). If it does in any row,
/// shorter steps are tried; if rounding spoils a row, as along a coordinate of 1e9 that moves the error by little,
/// longer ones. Every row keeps the slope that is least in doubt; where no two steps agree (noise, a kink) that of the
/// first step stays. Two evaluations mostly, at most 18.
template <typename Error, typename ErrorAt, typename Column>
inline void differentiateColumn(double step, const Error& error, const ErrorAt& errorAt, Column&& column) {
  constexpr double factor = 32.0;
  constexpr int shorter = 8, longer = 5;
  const CentralDifference<Error> first(step, error, errorAt);
  CentralDifference<Error> best = first;
  CentralDifference<Error> before = first;
  if (first.bends()) {
    for (int i = 0; i < shorter && best.bends(); ++i) {
      const CentralDifference<Error> next(step /= factor, error, errorAt);
      takeBetterRows(next, before, best);
      before = next;
    }
  } else if (first.rounds()) {
    for (int i = 0; i < longer && best.rounds(); ++i) {
      const CentralDifference<Error> next(step *= factor, error, errorAt);
      if (!takeBetterRows(next, before, best)) break;
      before = next;
    }
  }
  column = best.slope;
}

}  // namespace quiver::detail
