#pragma once

/// \file
/// The fisheye camera of Kannala and Brandt.

#include <quiver/geometry/camera_pinhole.h>

namespace quiver {

/// Intrinsics (fx, fy, cx, cy, k1, k2, k3, k4); looks along +z and sees points beside and behind it too. A ray at
/// the angle theta from the axis lands at the radius d(theta) = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 +
/// k4 theta^8), in the direction of (x, y). Smooth on the axis; undefined on its negative half.
struct CameraFisheye {
  static constexpr int intrinsicCount = 8;

  template <class S>
  static Vector<S, 2> project(const Vector<S, 8>& intrinsics, const Vector<S, 3>& p) {
    const Ray<S> ray(p);
    const S scale = ray.ratio * stretch(intrinsics, S(ray.theta * ray.theta));
    return Vector<S, 2>(intrinsics[0] * (scale * p[0]) + intrinsics[2], intrinsics[1] * (scale * p[1]) + intrinsics[3]);
  }
  /// d project / d point.
  template <class S>
  static Matrix<S, 2, 3> pointJacobian(const Vector<S, 8>& intrinsics, const Vector<S, 3>& p) {
    const Ray<S> ray(p);
    const S squared = ray.theta * ray.theta;
    const S scale = ray.ratio * stretch(intrinsics, squared);
    // scale = d(theta) / r: its derivative along r at fixed z is (d' z / (r^2 + z^2) - scale) / r, along z -d' / (...).
    const S slope = slopeOf(intrinsics, squared);
    const S inverse = 1.0 / (ray.squaredRadius + p[2] * p[2]);
    const S alongZ = -(slope * inverse);
    const S closed = (slope * p[2] * inverse - scale) / ray.safeSquaredRadius;
    const S cubed = 1.0 / (p[2] * p[2] * p[2]);
    const S curve = select(ray.nearAxis, S((2.0 * intrinsics[4] - 2.0 / 3) * cubed), closed);
    Matrix<S, 2, 3> j;
    QUIVER_UNROLL for (int i = 0; i < 2; ++i) {
      const S across = curve * p[i];
      j(i, 0) = intrinsics[i] * (across * p[0] + (i == 0 ? scale : S(0.0)));
      j(i, 1) = intrinsics[i] * (across * p[1] + (i == 1 ? scale : S(0.0)));
      j(i, 2) = intrinsics[i] * (p[i] * alongZ);
    }
    return j;
  }
  /// d project / d intrinsics.
  template <class S>
  static Matrix<S, 2, 8> intrinsicsJacobian(const Vector<S, 8>& intrinsics, const Vector<S, 3>& p) {
    const Ray<S> ray(p);
    const S squared = ray.theta * ray.theta;
    const S radius = stretch(intrinsics, squared);
    Matrix<S, 2, 8> j;
    QUIVER_UNROLL for (int i = 0; i < 2; ++i) {
      const S direction = ray.ratio * p[i];
      j(i, i) = direction * radius;
      j(i, 1 - i) = S(0.0);
      j(i, 2 + i) = S(1.0);
      j(i, 3 - i) = S(0.0);
      S power = intrinsics[i] * direction;
      QUIVER_UNROLL for (int k = 4; k < 8; ++k) {
        power *= squared;
        j(i, k) = power;
      }
    }
    return j;
  }
  /// The unit vector towards what is seen at a pixel, by ten Newton steps on the angle: exact within the region where
  /// d(theta) grows.
  template <class S>
  static Vector<S, 3> unproject(const Vector<S, 8>& intrinsics, const Vector<S, 2>& pixel) {
    using std::sqrt;
    const S u = (pixel[0] - intrinsics[2]) / intrinsics[0], v = (pixel[1] - intrinsics[3]) / intrinsics[1];
    const S squaredRadius = u * u + v * v;
    const auto nearAxis = squaredRadius < S(1e-18);
    const S radius = sqrt(select(nearAxis, S(1.0), squaredRadius));
    S theta = radius;
    for (int k = 0; k < 10; ++k) {
      const S squared = theta * theta;
      theta -= (theta * stretch(intrinsics, squared) - radius) / slopeOf(intrinsics, squared);
    }
    const SinCos<S> both = sincos(theta);
    const S scale = select(nearAxis, S(1.0), S(both.sine / radius));
    return Vector<S, 3>(u * scale, v * scale, select(nearAxis, S(1.0), both.cosine));
  }

 private:
  /// The angle from the axis, and theta / r with its limit 1 / z on the axis.
  template <class S>
  struct Ray {
    explicit Ray(const Vector<S, 3>& p) : squaredRadius(p[0] * p[0] + p[1] * p[1]) {
      using std::atan2, std::sqrt;
      nearAxis = squaredRadius < S(1e-12) * (p[2] * p[2]);
      safeSquaredRadius = select(nearAxis, S(1.0), squaredRadius);
      const S r = sqrt(safeSquaredRadius);
      const S tangent2 = squaredRadius / select(nearAxis, S(p[2] * p[2]), S(1.0));
      const S angle = atan2(r, p[2]);
      // On the axis theta/r = (1 - tan^2/3 + ...) / z and only theta^2 = tan^2 is needed, to first order in it.
      const S nearRatio = (1.0 - tangent2 * (1.0 / 3)) / select(nearAxis, p[2], S(1.0));
      ratio = select(nearAxis, nearRatio, S(angle / r));
      theta = select(nearAxis, S(nearRatio * sqrt(squaredRadius)), angle);
    }
    S squaredRadius;
    MaskOf<S> nearAxis;
    S safeSquaredRadius, ratio, theta;
  };
  /// d(theta) / theta.
  template <class S>
  static S stretch(const Vector<S, 8>& k, const S& squared) {
    return 1.0 + squared * (k[4] + squared * (k[5] + squared * (k[6] + squared * k[7])));
  }
  /// d'(theta).
  template <class S>
  static S slopeOf(const Vector<S, 8>& k, const S& squared) {
    return 1.0 + squared * (3.0 * k[4] + squared * (5.0 * k[5] + squared * (7.0 * k[6] + squared * (9.0 * k[7]))));
  }
};

}  // namespace quiver
