#pragma once

/// \file
/// The camera of the "bundle adjustment in the large" data sets.

#include <quiver/geometry/linear.h>

namespace quiver {

/// Intrinsics (f [pixel], k1, k2), principal point at 0; the camera looks along -z, y up. With p = -(x, y) / z:
/// pixel = f (1 + k1 |p|^2 + k2 |p|^4) p.
struct CameraSnavely {
  static constexpr int intrinsicCount = 3;

  /// Whether the point is in front of this camera: z < -minimum.
  template <class S>
  static auto isDepthPositive(const Vector<S, 3>& pointInCamera, double minimum = 0.0) {
    return pointInCamera[2] < S(-minimum);
  }
  template <class S>
  static Vector<S, 2> project(const Vector<S, 3>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = -1.0 / p[2];
    const S x = p[0] * inverse, y = p[1] * inverse;
    const S squared = x * x + y * y;
    const S scale = intrinsics[0] * (1.0 + squared * (intrinsics[1] + squared * intrinsics[2]));
    return Vector<S, 2>(scale * x, scale * y);
  }
  /// d project / d point.
  template <class S>
  static Matrix<S, 2, 3> pointJacobian(const Vector<S, 3>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = -1.0 / p[2];
    const S x = p[0] * inverse, y = p[1] * inverse;
    const S squared = x * x + y * y;
    const S f = intrinsics[0] * inverse;
    const S scale = f * (1.0 + squared * (intrinsics[1] + squared * intrinsics[2]));
    const S slope = 2.0 * f * (intrinsics[1] + 2.0 * squared * intrinsics[2]);
    Matrix<S, 2, 3> j;
    j(0, 0) = scale + slope * (x * x);
    j(1, 1) = scale + slope * (y * y);
    j(0, 1) = j(1, 0) = slope * (x * y);
    const S total = scale + slope * squared;
    j(0, 2) = total * x;
    j(1, 2) = total * y;
    return j;
  }
  /// d project / d intrinsics.
  template <class S>
  static Matrix<S, 2, 3> intrinsicsJacobian(const Vector<S, 3>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = -1.0 / p[2];
    const S squared = (p[0] * p[0] + p[1] * p[1]) * (inverse * inverse);
    Matrix<S, 2, 3> j;
    QUIVER_UNROLL for (int i = 0; i < 2; ++i) {
      const S x = p[i] * inverse;
      j(i, 0) = x * (1.0 + squared * (intrinsics[1] + squared * intrinsics[2]));
      j(i, 1) = intrinsics[0] * x * squared;
      j(i, 2) = j(i, 1) * squared;
    }
    return j;
  }
  /// The point at z = -1 seen at a pixel, by ten Newton steps on the radius: exact within the region where the
  /// distortion is monotonous.
  template <class S>
  static Vector<S, 3> unproject(const Vector<S, 3>& intrinsics, const Vector<S, 2>& pixel) {
    const S u = pixel[0] / intrinsics[0], v = pixel[1] / intrinsics[0];
    const S squaredTarget = u * u + v * v;
    // With m = |p| / |distorted p|: m (1 + k1 m^2 R + k2 m^4 R^2) = 1 where R = |distorted p|^2.
    const S a = intrinsics[1] * squaredTarget, b = intrinsics[2] * squaredTarget * squaredTarget;
    S m(1.0);
    for (int k = 0; k < 10; ++k) {
      const S squared = m * m;
      m -= (m * (1.0 + squared * (a + squared * b)) - 1.0) / (1.0 + squared * (3.0 * a + 5.0 * squared * b));
    }
    return Vector<S, 3>(u * m, v * m, S(-1.0));
  }
};

}  // namespace quiver
