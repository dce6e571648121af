#pragma once

/// \file
/// The pinhole camera without distortion.

#include <quiver/geometry/linear.h>

namespace quiver {

/// Whether a point in a camera that looks along +z is in front of it: z > minimum [m].
template <class S>
inline auto isDepthPositive(const Vector<S, 3>& pointInCamera, double minimum = 0.0) {
  return pointInCamera[2] > S(minimum);
}

/// Intrinsics (fx, fy, cx, cy) [pixel]; the camera looks along +z, x to the right, y down.
struct CameraPinhole {
  static constexpr int intrinsicCount = 4;

  /// The pixel of a point in the camera's frame; infinite in the plane z = 0, mirrored behind it.
  template <class S>
  static Vector<S, 2> project(const Vector<S, 4>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = 1.0 / p[2];
    return Vector<S, 2>(intrinsics[0] * (p[0] * inverse) + intrinsics[2],
                        intrinsics[1] * (p[1] * inverse) + intrinsics[3]);
  }
  /// d project / d point.
  template <class S>
  static Matrix<S, 2, 3> pointJacobian(const Vector<S, 4>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = 1.0 / p[2];
    const S u = intrinsics[0] * inverse, v = intrinsics[1] * inverse;
    Matrix<S, 2, 3> j;
    j(0, 0) = u;
    j(0, 1) = S(0.0);
    j(0, 2) = -(u * (p[0] * inverse));
    j(1, 0) = S(0.0);
    j(1, 1) = v;
    j(1, 2) = -(v * (p[1] * inverse));
    return j;
  }
  /// d project / d intrinsics.
  template <class S>
  static Matrix<S, 2, 4> intrinsicsJacobian(const Vector<S, 4>&, const Vector<S, 3>& p) {
    const S inverse = 1.0 / p[2];
    Matrix<S, 2, 4> j;
    j(0, 0) = p[0] * inverse;
    j(1, 1) = p[1] * inverse;
    j(0, 2) = j(1, 3) = S(1.0);
    j(0, 1) = j(0, 3) = j(1, 0) = j(1, 2) = S(0.0);
    return j;
  }
  /// The point at z = 1 seen at a pixel.
  template <class S>
  static Vector<S, 3> unproject(const Vector<S, 4>& intrinsics, const Vector<S, 2>& pixel) {
    return Vector<S, 3>((pixel[0] - intrinsics[2]) / intrinsics[0], (pixel[1] - intrinsics[3]) / intrinsics[1], S(1.0));
  }
};

}  // namespace quiver
