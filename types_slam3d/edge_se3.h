#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/quaternion_error.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// The pose of one robot position seen from another: e = (t, q_xyz) of D = Z⁻¹ X₁⁻¹ X₂ with q_w ≥ 0 (g2o's
/// EDGE_SE3:QUAT).
class EdgeSE3 : public BaseEdge<EdgeSE3, 6, SE3<double>, VertexSE3, VertexSE3> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to) {
    return detail::quaternionError<S>(z.between(from.between(to)));
  }

  /// With E = X₁⁻¹ X₂: D = Z⁻¹ Exp(−δ₁) E, and D Exp(δ₂).
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to, Matrix<S, 6, 6>& J0,
                             Matrix<S, 6, 6>& J1) {
    const SE3<S> E = from.between(to);
    const SE3<S> D = z.between(E);
    detail::quaternionErrorByInverse<S>(D, z.rotation().inverse().matrix(), E.translation(), J0);
    detail::quaternionErrorByRight<S>(D, J1);
  }

  /// X₂ = X₁ Z, X₁ = X₂ Z⁻¹.
  static bool initialEstimate(int to, const SE3<double>& z, SE3<double>& first, SE3<double>& second) {
    if (to == 1) {
      second = first * z;
    } else {
      first = second * z.inverse();
    }
    return true;
  }
};

}  // namespace quiver
