#pragma once

#include <span>
#include <string_view>

#include <quiver/geometry/linear.h>

namespace quiver {

/// The motions among which an alignment is sought.
enum class AlignmentGroup {
  /// The identity alone.
  none,
  /// Motions of the plane z = 0: a rotation about z, a shift along x and y.
  se2,
  se3,
  /// Rigid motions and a scale.
  sim3,
};

/// p ↦ scale · rotation · p + translation.
struct Alignment {
  double scale = 1.0;
  Matrix<double, 3, 3> rotation = Matrix<double, 3, 3>::Identity();
  Vector<double, 3> translation = Vector<double, 3>::Zero();
  /// Whether the points leave only one best motion. If they lie on a line (for se2: at one point), any turn about it is
  /// as good; errors of positions are still the least ones, those of rotations mean nothing.
  bool unique = true;

  Vector<double, 3> operator*(const Vector<double, 3>& p) const { return scale * (rotation * p) + translation; }
};

/// The motion of the group that minimises Σ ‖to_i − A from_i‖². Source: S. Umeyama, Least-squares estimation of
/// transformation parameters between two point patterns, 1991; in the plane in closed form. Scale is 1 if the points of
/// `from` coincide. Throws GraphError if the numbers of points differ or are zero. O(n).
Alignment alignPoints(std::span<const Vector<double, 3>> from, std::span<const Vector<double, 3>> to,
                      AlignmentGroup group);

/// "none", "se2", "se3", "sim3".
std::string_view nameOf(AlignmentGroup group);

}  // namespace quiver
