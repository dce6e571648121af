#pragma once

#include <cmath>
#include <type_traits>
#include <utility>

#include <quiver/geometry/packing.h>
#include <quiver/geometry/se2.h>
#include <quiver/geometry/se3.h>

namespace quiver {

/// What a vertex is in the world, for pictures and trajectories.
enum class PlaceKind { none, planarPoint, point, planarPose, pose };

inline bool isPose(PlaceKind kind) { return kind == PlaceKind::planarPose || kind == PlaceKind::pose; }
inline bool isPlanar(PlaceKind kind) { return kind == PlaceKind::planarPose || kind == PlaceKind::planarPoint; }

namespace detail {

struct NoPlace {};

/// What a vertex type's `place(estimate)` says; an SE2 or SE3 is a place itself.
template <typename V>
auto placeOf(const typename V::Estimate& x) {
  using Estimate = typename V::Estimate;
  if constexpr (requires { V::place(x); }) {
    return V::place(x);
  } else if constexpr (std::is_same_v<Estimate, SE2<double>> || std::is_same_v<Estimate, SE3<double>>) {
    return x;
  } else {
    return NoPlace();
  }
}

template <typename V>
constexpr PlaceKind placeKindOf() {
  using Place = decltype(placeOf<V>(std::declval<const typename V::Estimate&>()));
  if constexpr (std::is_same_v<Place, NoPlace>) {
    return PlaceKind::none;
  } else if constexpr (std::is_same_v<Place, Vector<double, 2>>) {
    return PlaceKind::planarPoint;
  } else if constexpr (std::is_same_v<Place, Vector<double, 3>>) {
    return PlaceKind::point;
  } else if constexpr (std::is_same_v<Place, SE2<double>>) {
    return PlaceKind::planarPose;
  } else {
    static_assert(std::is_same_v<Place, SE3<double>>,
                  "place(estimate) returns a Vector<double, 2>, Vector<double, 3>, SE2<double> or SE3<double>");
    return PlaceKind::pose;
  }
}

inline SE3<double> inSpace(const NoPlace&) { return {}; }
inline SE3<double> inSpace(const Vector<double, 2>& x) { return {SO3<double>(), Vector<double, 3>(x[0], x[1], 0.0)}; }
inline SE3<double> inSpace(const Vector<double, 3>& x) { return {SO3<double>(), x}; }
inline SE3<double> inSpace(const SE3<double>& x) { return x; }
inline SE3<double> inSpace(const SE2<double>& x) {
  const double half = 0.5 * x.toVector()[2];
  return SE3<double>(x.translation()[0], x.translation()[1], 0.0, 0.0, 0.0, std::sin(half), std::cos(half));
}

}  // namespace detail
}  // namespace quiver
