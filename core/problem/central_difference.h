#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <quiver/geometry/linear.h>

namespace quiver::detail {

inline constexpr double differenceStep = 6.055454452393343e-06;  // cube root of the double's epsilon

/// The first step of a central difference along one direction of a tangent: ε^⅓ times the cube root of the size of what
/// it moves, at least 1. Of a coordinate x the error's rounding is ε|x|, so that (ε|x|)^⅓ loses least where the error
/// bends over lengths of about 1, however far away the world's origin is (UTM coordinates, say).
template <typename Estimate>
inline double firstDifferenceStep(const Estimate& x, int direction) {
  const auto stepOf = [](double size) { return differenceStep * std::cbrt(std::max(1.0, size)); };
  if constexpr (std::is_same_v<Estimate, double>) {
    return stepOf(std::abs(x));
  } else if constexpr (requires { x.translation(); }) {
    // Translation comes first in every tangent; it moves in metres, rotation and scale in radians and logarithms.
    if (direction >= x.translation().size()) return differenceStep;
    return stepOf(x.translation().cwiseAbs().maxCoeff());
  } else if constexpr (requires {
                         x.size();
                         x[0];
                       }) {
    return direction < x.size() ? stepOf(std::abs(x[direction])) : differenceStep;
  } else {
    return differenceStep;
  }
}

/// Column of a Jacobian by central differences of `errorAt(step)`, `error` being errorAt(0).
///
/// The second difference, which costs nothing, tells whether the error bends within the step, as it does along a
/// coordinate whose own size is 1e-7 (a distortion in pixels⁻², a rate in nanoseconds⁻¹): it is then as large as the
/// first difference or larger. If so, shorter steps are tried down to where the error is straight and two steps agree;
/// if there is no such step (noise, a kink), the first one stays. O(1) more evaluations, at most 18.
template <typename Error, typename ErrorAt, typename Column>
inline void differentiateColumn(double step, const Error& error, ErrorAt&& errorAt, Column&& column) {
  constexpr double straight = 1e-4;  // second difference by first, where the truncation error is about its square
  constexpr double agreement = 1e-2;
  constexpr double negligible = 1e-5;  // of the column: less may be the rounding of the shorter step
  constexpr double shorter = 1.0 / 32.0;
  constexpr int tries = 8;
  bool isStraight = false;
  const auto differentiate = [&](double h) {
    const Error forward = errorAt(h);
    const Error backward = errorAt(-h);
    const double rise = (forward - backward).norm();
    isStraight = std::isfinite(rise) && (forward + backward - 2.0 * error).norm() <= straight * rise;
    return Error((forward - backward) / (2.0 * h));
  };
  const Error first = differentiate(step);
  column = first;
  if (isStraight) return;
  bool before = false;
  Error longer = first;
  for (int i = 0; i < tries; ++i) {
    step *= shorter;
    const Error next = differentiate(step);
    const double size = next.norm();
    if (before && isStraight && (next - longer).norm() <= agreement * size) {
      if (!((next - first).norm() <= negligible * size)) column = next;
      return;
    }
    before = isStraight && size > 0.0;
    longer = next;
  }
}

}  // namespace quiver::detail
