#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/expmap/parameter_camera_parameters.h>
#include <quiver/types_sba/expmap/vertex_se3_expmap.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

namespace detail {

/// What XYZ2UV and XYZ2UVU share: e = z − view(X⁻¹ l), the intrinsics being a parameter.
template <typename Edge, int Rows>
class ExpmapProjection : public BaseEdge<Edge, Rows, Vector<double, Rows>, VertexXYZ, VertexSE3Expmap> {
 public:
  using Parameters = ParameterList<ParameterCameraParameters>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, Rows> computeError(const Vector<S, Rows>& z, const Vector<S, 4>& k, const Vector<S, 3>& point,
                                      const SE3<S>& pose) {
    return difference<S, Rows>(z, stereoCamera<S>(k).template project<Rows>(pose.actInverse(point)));
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, Rows>&, const Vector<S, 4>& k, const Vector<S, 3>& point,
                             const SE3<S>& pose, Matrix<S, Rows, 3>& J0, Matrix<S, Rows, 6>& J1) {
    const Vector<S, 3> p = pose.actInverse(point);
    projectionJacobians<S, Rows>(stereoCamera<S>(k).template pointJacobian<Rows>(p, -1.0), pose, p, J1, J0);
  }
  static bool isDepthPositive(const Vector<double, Rows>&, const Vector<double, 4>&, const Vector<double, 3>& point,
                              const SE3<double>& pose) {
    return pose.actInverse(point)[2] > 0.0;
  }
  /// A stereo pair tells the point.
  static bool initialEstimate(int to, const Vector<double, Rows>& z, const Vector<double, 4>& k,
                              Vector<double, 3>& point, SE3<double>& pose) {
    if constexpr (Rows == 3) {
      if (to != 0 || !triangulate(stereoCamera<double>(k), z, point)) return false;
      point = pose * point;
      return true;
    }
    return false;
  }
  static std::vector<Field> fields() { return pixelFields<Rows>(); }
};

}  // namespace detail

/// A pixel of a point: e = z − π(X⁻¹ l) (g2o's EDGE_PROJECT_XYZ2UV:EXPMAP).
class EdgeProjectXYZ2UV : public detail::ExpmapProjection<EdgeProjectXYZ2UV, 2> {};

/// A pixel of a point and its column in the right image (g2o's EDGE_PROJECT_XYZ2UVU:EXPMAP).
class EdgeProjectXYZ2UVU : public detail::ExpmapProjection<EdgeProjectXYZ2UVU, 3> {};

}  // namespace quiver
