#pragma once

#include <quiver/geometry/packing.h>
#include <array>

#include "tests/geometry/scalar_support.h"

namespace quiver::test {

/// A group by name, its elements over any scalar.
struct PlaneRotations {
  template <class S>
  using Of = SO2<S>;
};
struct PlaneMotions {
  template <class S>
  using Of = SE2<S>;
};
struct Rotations {
  template <class S>
  using Of = SO3<S>;
};
struct Motions {
  template <class S>
  using Of = SE3<S>;
};
struct Similarities {
  template <class S>
  using Of = Sim3<S>;
};

template <class Group>
inline constexpr int dimensionOf = Group::template Of<double>::dimension;
template <class Group>
using TangentOf = Vector<double, dimensionOf<Group>>;
/// Dimension of the points the group acts on.
template <class Group>
inline constexpr int spaceOf = std::is_same_v<Group, PlaneRotations> || std::is_same_v<Group, PlaneMotions> ? 2 : 3;

/// A random tangent whose rotation has the given angle.
template <class Group>
TangentOf<Group> randomTangent(std::mt19937_64& generator, double angle) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  TangentOf<Group> v;
  for (double& each : v) each = uniform(generator);
  constexpr int n = dimensionOf<Group>;
  if constexpr (spaceOf<Group> == 2) {
    v[n - 1] = uniform(generator) < 0 ? -angle : angle;
  } else {
    constexpr int first = n == 3 ? 0 : 3;
    v.template segment<3>(first) *= angle / v.template segment<3>(first).norm();
    if constexpr (n == 7) v[6] *= 0.7;
  }
  return v;
}

inline constexpr std::array angles{0.0, 1e-12,    1e-9,     1e-7, 1e-5, 9.9e-4, 1.1e-3, 0.02,
                                   0.4, 0.999999, 1.000001, 1.5,  2.5,  3.0,    3.14,   pi - 1e-4};

}  // namespace quiver::test
