#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/parameter_se3_offset.h>
#include <quiver/types_slam3d/point_jacobian.h>
#include <quiver/types_slam3d/vertex_se3.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

/// A point seen by a sensor: e = (X P)⁻¹ l − z, P the sensor in the body (g2o's EDGE_SE3_TRACKXYZ).
class EdgeSE3XYZ : public BaseEdge<EdgeSE3XYZ, 3, Vector<double, 3>, VertexSE3, VertexXYZ> {
 public:
  using Parameters = ParameterList<ParameterSE3Offset>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 3>& z, const SE3<S>& offset, const SE3<S>& pose,
                                   const Vector<S, 3>& point) {
    const Vector<S, 3> p = offset.actInverse(pose.actInverse(point));
    return Vector<S, 3>(p[0] - z[0], p[1] - z[1], p[2] - z[2]);
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 3>&, const SE3<S>& offset, const SE3<S>& pose, const Vector<S, 3>& point,
                             Matrix<S, 3, 6>& J0, Matrix<S, 3, 3>& J1) {
    const Matrix<S, 3, 3> toSensor = offset.rotation().inverse().matrix();
    detail::seenPointByPose<S, 3>(toSensor, pose.actInverse(point), J0);
    J1 = detail::product3<S>(toSensor, pose.rotation().inverse().matrix());
  }

  /// l = X P z; a point alone does not tell the pose.
  static bool initialEstimate(int to, const Vector<double, 3>& z, const SE3<double>& offset, SE3<double>& pose,
                              Vector<double, 3>& point) {
    if (to != 1) return false;
    point = pose * (offset * z);
    return true;
  }
};

}  // namespace quiver
