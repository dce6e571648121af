#pragma once

/// \file
/// The camera with radial and tangential distortion of Brown and Conrady.

#include <quiver/geometry/camera_pinhole.h>

namespace quiver {

/// Intrinsics (fx, fy, cx, cy, k1, k2, p1, p2, k3), the order of the coefficients as OpenCV has it; looks along +z.
/// With (x, y) on the plane z = 1 and r^2 = x^2 + y^2:
///   x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), and y' likewise with p1 and p2 exchanged.
struct CameraBrown {
  static constexpr int intrinsicCount = 9;

  template <class S>
  static Vector<S, 2> project(const Vector<S, 9>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = 1.0 / p[2];
    const Vector<S, 2> d = distort(intrinsics, Vector<S, 2>(p[0] * inverse, p[1] * inverse));
    return Vector<S, 2>(intrinsics[0] * d[0] + intrinsics[2], intrinsics[1] * d[1] + intrinsics[3]);
  }
  /// d project / d point.
  template <class S>
  static Matrix<S, 2, 3> pointJacobian(const Vector<S, 9>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = 1.0 / p[2];
    const S x = p[0] * inverse, y = p[1] * inverse;
    const Matrix<S, 2, 2> d = distortionJacobian(intrinsics, Vector<S, 2>(x, y));
    Matrix<S, 2, 3> j;
    QUIVER_UNROLL for (int i = 0; i < 2; ++i) {
      const S scale = intrinsics[i] * inverse;
      j(i, 0) = scale * d(i, 0);
      j(i, 1) = scale * d(i, 1);
      j(i, 2) = -(j(i, 0) * x + j(i, 1) * y);
    }
    return j;
  }
  /// d project / d intrinsics.
  template <class S>
  static Matrix<S, 2, 9> intrinsicsJacobian(const Vector<S, 9>& intrinsics, const Vector<S, 3>& p) {
    const S inverse = 1.0 / p[2];
    const S x = p[0] * inverse, y = p[1] * inverse;
    const Vector<S, 2> d = distort(intrinsics, Vector<S, 2>(x, y));
    const S xx = x * x, yy = y * y, xy = 2.0 * (x * y), r2 = xx + yy;
    Matrix<S, 2, 9> j;
    QUIVER_UNROLL for (int i = 0; i < 2; ++i) {
      const S& f = intrinsics[i];
      const S along = f * (i == 0 ? x : y) * r2;
      j(i, i) = d[i];
      j(i, 1 - i) = S(0.0);
      j(i, 2 + i) = S(1.0);
      j(i, 3 - i) = S(0.0);
      j(i, 4) = along;
      j(i, 5) = along * r2;
      j(i, 6) = f * (i == 0 ? xy : S(r2 + 2.0 * yy));
      j(i, 7) = f * (i == 0 ? S(r2 + 2.0 * xx) : xy);
      j(i, 8) = along * r2 * r2;
    }
    return j;
  }
  /// The point at z = 1 seen at a pixel, by ten Newton steps from the undistorted one: exact within the region where
  /// the distortion is monotonous.
  template <class S>
  static Vector<S, 3> unproject(const Vector<S, 9>& intrinsics, const Vector<S, 2>& pixel) {
    const S u = (pixel[0] - intrinsics[2]) / intrinsics[0], v = (pixel[1] - intrinsics[3]) / intrinsics[1];
    S x = u, y = v;
    for (int k = 0; k < 10; ++k) {
      const Vector<S, 2> d = distort(intrinsics, Vector<S, 2>(x, y));
      const Matrix<S, 2, 2> j = distortionJacobian(intrinsics, Vector<S, 2>(x, y));
      const S a = u - d[0], b = v - d[1];
      const S inverse = 1.0 / (j(0, 0) * j(1, 1) - j(0, 1) * j(1, 0));
      x += inverse * (j(1, 1) * a - j(0, 1) * b);
      y += inverse * (j(0, 0) * b - j(1, 0) * a);
    }
    return Vector<S, 3>(x, y, S(1.0));
  }

 private:
  template <class S>
  static Vector<S, 2> distort(const Vector<S, 9>& intrinsics, const Vector<S, 2>& at) {
    const S &x = at[0], &y = at[1], &p1 = intrinsics[6], &p2 = intrinsics[7];
    const S r2 = x * x + y * y, xy = 2.0 * (x * y);
    const S radial = 1.0 + r2 * (intrinsics[4] + r2 * (intrinsics[5] + r2 * intrinsics[8]));
    return Vector<S, 2>(x * radial + p1 * xy + p2 * (r2 + 2.0 * (x * x)),
                        y * radial + p2 * xy + p1 * (r2 + 2.0 * (y * y)));
  }
  /// d distort / d (x, y); symmetric.
  template <class S>
  static Matrix<S, 2, 2> distortionJacobian(const Vector<S, 9>& intrinsics, const Vector<S, 2>& at) {
    const S &x = at[0], &y = at[1], &p1 = intrinsics[6], &p2 = intrinsics[7];
    const S r2 = x * x + y * y;
    const S radial = 1.0 + r2 * (intrinsics[4] + r2 * (intrinsics[5] + r2 * intrinsics[8]));
    const S slope = 2.0 * (intrinsics[4] + r2 * (2.0 * intrinsics[5] + r2 * (3.0 * intrinsics[8])));  // 2 d radial/d r2
    Matrix<S, 2, 2> j;
    j(0, 0) = radial + slope * (x * x) + 2.0 * (p1 * y) + 6.0 * (p2 * x);
    j(1, 1) = radial + slope * (y * y) + 2.0 * (p2 * x) + 6.0 * (p1 * y);
    j(0, 1) = j(1, 0) = slope * (x * y) + 2.0 * (p1 * x) + 2.0 * (p2 * y);
    return j;
  }
};

}  // namespace quiver
