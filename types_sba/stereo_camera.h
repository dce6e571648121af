#pragma once

#include <quiver/core/registry/fields.h>
#include <quiver/types_slam3d/point_jacobian.h>

namespace quiver::detail {

/// A rectified pair of pinhole cameras without distortion that look along +z: what the left one sees and, as a third
/// number, u in the right one, f_x (x − b) / z + c_x. `shift` is f_x b; a single camera does not use it.
template <typename S>
struct StereoCamera {
  S fx, fy, cx, cy, shift;

  template <int Rows>
  Vector<S, Rows> project(const Vector<S, 3>& p) const {
    static_assert(Rows == 2 || Rows == 3);
    const S w = 1.0 / p[2];
    Vector<S, Rows> pixel;
    pixel[0] = fx * (p[0] * w) + cx;
    pixel[1] = fy * (p[1] * w) + cy;
    if constexpr (Rows == 3) pixel[2] = pixel[0] - shift * w;
    return pixel;
  }

  /// sign · ∂project/∂p.
  template <int Rows>
  Matrix<S, Rows, 3> pointJacobian(const Vector<S, 3>& p, double sign) const {
    const S w = 1.0 / p[2];
    const S u = (sign * fx) * w, v = (sign * fy) * w;
    Matrix<S, Rows, 3> N;
    N(0, 0) = u, N(0, 1) = S(0.0), N(0, 2) = -(u * (p[0] * w));
    N(1, 0) = S(0.0), N(1, 1) = v, N(1, 2) = -(v * (p[1] * w));
    if constexpr (Rows == 3) {
      N(2, 0) = u, N(2, 1) = S(0.0), N(2, 2) = N(0, 2) + (sign * shift) * w * w;
    }
    return N;
  }
};

/// The point at which a stereo pair sees (u, v, u_right), in the left camera; false for no disparity or a negative one.
inline bool triangulate(const StereoCamera<double>& camera, const Vector<double, 3>& z, Vector<double, 3>& p) {
  const double disparity = z[0] - z[2];
  if (!(disparity > 0.0) || !(camera.shift > 0.0)) return false;
  const double depth = camera.shift / disparity;
  p = Vector<double, 3>((z[0] - camera.cx) / camera.fx * depth, (z[1] - camera.cy) / camera.fy * depth, depth);
  return true;
}

/// With N = ∂e/∂p at p = X⁻¹ l: N [−I, [p]ₓ] by the pose, N Rᵀ by the point.
template <typename S, int Rows>
inline void projectionJacobians(const Matrix<S, Rows, 3>& N, const SE3<S>& pose, const Vector<S, 3>& p,
                                Matrix<S, Rows, 6>& byPose, Matrix<S, Rows, 3>& byPoint) {
  seenPointByPose<S, Rows>(N, p, byPose);
  const Matrix<S, 3, 3> R = pose.rotation().matrix();
  QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
    QUIVER_UNROLL for (int r = 0; r < Rows; ++r) {
      byPoint(r, c) = N(r, 0) * R(c, 0) + N(r, 1) * R(c, 1) + N(r, 2) * R(c, 2);
    }
  }
}

/// Names of a pixel's numbers: u v, and u_right for three rows.
template <int Rows>
std::vector<Field> pixelFields() {
  std::vector<Field> fields{{"u", "px", ""}, {"v", "px", ""}};
  if (Rows == 3) fields.push_back({"u_right", "px", "in the right camera"});
  return fields;
}

/// a − b, without temporaries of Eigen in lanes.
template <typename S, int Rows>
inline Vector<S, Rows> difference(const Vector<S, Rows>& a, const Vector<S, Rows>& b) {
  Vector<S, Rows> d;
  QUIVER_UNROLL for (int r = 0; r < Rows; ++r) d[r] = a[r] - b[r];
  return d;
}

}  // namespace quiver::detail
