#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/point_jacobian.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {

/// A point seen from a pose: e = X⁻¹ l − z (g2o's EDGE_SE2_XY).
class EdgeSE2XY : public BaseEdge<EdgeSE2XY, 2, Vector<double, 2>, VertexSE2, VertexXY> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& pose, const Vector<S, 2>& point) {
    return pose.actInverse(point) - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE2<S>& pose, const Vector<S, 2>& point, Matrix<S, 2, 3>& J0,
                             Matrix<S, 2, 2>& J1) {
    detail::seenPointByPose<S>(pose.actInverse(point), J0);
    detail::transposedRotation<S>(pose.rotation(), J1);
  }

  /// l = X z; a point alone does not tell the pose.
  static bool initialEstimate(int to, const Vector<double, 2>& z, SE2<double>& pose, Vector<double, 2>& point) {
    if (to != 1) return false;
    point = pose * z;
    return true;
  }
};

}  // namespace quiver
