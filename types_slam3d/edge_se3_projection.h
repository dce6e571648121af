#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/parameter_camera.h>
#include <quiver/types_slam3d/point_jacobian.h>
#include <quiver/types_slam3d/vertex_se3.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

namespace detail {

/// What the two depth cameras share: with p = (X P)⁻¹ l, the pixel (f_x p_x/p_z + c_x, f_y p_y/p_z + c_y) and a third
/// number, 1/p_z or p_z.
template <typename Edge, bool inverse>
class DepthCameraEdge : public BaseEdge<Edge, 3, Vector<double, 3>, VertexSE3, VertexXYZ> {
 public:
  using Parameters = ParameterList<ParameterCamera>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 3>& z, const Vector<S, 11>& camera, const SE3<S>& pose,
                                   const Vector<S, 3>& point) {
    const Vector<S, 3> p = cameraPose(camera).actInverse(pose.actInverse(point));
    const S w = 1.0 / p[2];
    return Vector<S, 3>(camera[7] * (p[0] * w) + camera[9] - z[0], camera[8] * (p[1] * w) + camera[10] - z[1],
                        S(inverse ? w : p[2]) - z[2]);
  }

  /// With N = ∂(u, v, w)/∂p: N R_Pᵀ [−I, [X⁻¹ l]ₓ] by the pose, N R_Pᵀ R_Xᵀ by the point.
  template <typename S>
  static void linearizeOplus(const Vector<S, 3>&, const Vector<S, 11>& camera, const SE3<S>& pose,
                             const Vector<S, 3>& point, Matrix<S, 3, 6>& J0, Matrix<S, 3, 3>& J1) {
    const SE3<S> inBody = cameraPose(camera);
    const Vector<S, 3> seen = pose.actInverse(point);
    const Vector<S, 3> p = inBody.actInverse(seen);
    const S w = 1.0 / p[2];
    const S fx = camera[7] * w, fy = camera[8] * w;
    const Matrix<S, 3, 3> R = inBody.rotation().inverse().matrix();
    Matrix<S, 3, 3> N;
    QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
      N(0, c) = fx * (R(0, c) - p[0] * w * R(2, c));
      N(1, c) = fy * (R(1, c) - p[1] * w * R(2, c));
      N(2, c) = inverse ? S(-w * w * R(2, c)) : R(2, c);
    }
    seenPointByPose<S, 3>(N, seen, J0);
    J1 = product3<S>(N, pose.rotation().inverse().matrix());
  }

  static bool initialEstimate(int to, const Vector<double, 3>& z, const Vector<double, 11>& camera, SE3<double>& pose,
                              Vector<double, 3>& point) {
    if (to != 1 || !(z[2] > 0.0)) return false;
    const double depth = inverse ? 1.0 / z[2] : z[2];
    const Vector<double, 3> p((z[0] - camera[9]) / camera[7] * depth, (z[1] - camera[10]) / camera[8] * depth, depth);
    point = pose * (cameraPose(camera) * p);
    return true;
  }

  static std::vector<Field> fields() {
    if (inverse) return {{"u", "px", ""}, {"v", "px", ""}, {"disparity", "1/m", "disparity / (fx baseline)"}};
    return {{"u", "px", ""}, {"v", "px", ""}, {"depth", "m", ""}};
  }
};

}  // namespace detail

/// A pixel and the normalised disparity 1/p_z of a point (g2o's EDGE_PROJECT_DISPARITY).
class EdgeSE3Disparity : public detail::DepthCameraEdge<EdgeSE3Disparity, true> {};

/// A pixel and the depth p_z of a point (g2o's EDGE_PROJECT_DEPTH).
class EdgeSE3Depth : public detail::DepthCameraEdge<EdgeSE3Depth, false> {};

}  // namespace quiver
