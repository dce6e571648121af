#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/parameter_se3_offset.h>
#include <quiver/types_slam3d/quaternion_error.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// A sensor's pose measured in the world: e = (t, q_xyz) of Z⁻¹ X P, P the sensor in the body (g2o's EDGE_SE3_PRIOR).
class EdgeSE3Prior : public BaseEdge<EdgeSE3Prior, 6, SE3<double>, VertexSE3> {
 public:
  using Parameters = ParameterList<ParameterSE3Offset>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& offset, const SE3<S>& x) {
    return detail::quaternionError<S>(z.between(x * offset));
  }

  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& offset, const SE3<S>& x, Matrix<S, 6, 6>& J) {
    const SE3<S> A = z.between(x);
    detail::quaternionErrorByMiddle<S>(A * offset, A.rotation().matrix(), offset.translation(), J);
  }

  /// X = Z P⁻¹.
  static bool initialEstimate(int, const SE3<double>& z, const SE3<double>& offset, SE3<double>& x) {
    x = z * offset.inverse();
    return true;
  }
};

}  // namespace quiver
