#pragma once

/// \file
/// Choosing without branching, for every scalar: double, lanes, and dual numbers over either.

#include <quiver/geometry/scalar/lanes.h>
#include <cmath>

namespace quiver {

/// a if `truth`, else b. Both are evaluated. The form for lanes takes a mask and chooses lane by lane.
template <class T>
inline T select(bool truth, const T& a, const std::type_identity_t<T>& b) {
  return truth ? a : b;
}

inline bool any(bool truth) { return truth; }
inline bool all(bool truth) { return truth; }

/// +1 where x >= 0, -1 elsewhere (never 0).
inline double signOf(double x) { return x >= 0.0 ? 1.0 : -1.0; }
template <class Isa>
inline Lanes<Isa> signOf(const Lanes<Isa>& x) {
  return select(x >= Lanes<Isa>(0.0), Lanes<Isa>(1.0), Lanes<Isa>(-1.0));
}

/// The number without derivatives: what decisions are made on.
inline double valueOf(double x) { return x; }
template <class Isa>
inline Lanes<Isa> valueOf(const Lanes<Isa>& x) {
  return x;
}

}  // namespace quiver
