#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/vertex_se2.h>

namespace quiver {

/// The pose of one robot position seen from another: e = Z⁻¹ (X₁⁻¹ X₂) as (x, y, θ) (g2o's EDGE_SE2).
class EdgeSE2 : public BaseEdge<EdgeSE2, 3, SE2<double>, VertexSE2, VertexSE2> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 3> computeError(const SE2<S>& z, const SE2<S>& from, const SE2<S>& to) {
    const Vector<S, 2> t = z.actInverse(from.actInverse(to.translation()));
    return Vector<S, 3>(t[0], t[1], wrapAngle(S(to.angle() - from.angle() - z.angle())));
  }

  /// With R = R_zᵀ R₁ᵀ and p = X₁⁻¹ t₂: ∂/∂from = [−R_zᵀ, −R_zᵀ J p; 0, −1], ∂/∂to = [R_zᵀ R₁ᵀ R₂, 0; 0, 1], J the
  /// quarter turn.
  template <typename S>
  static void linearizeOplus(const SE2<S>& z, const SE2<S>& from, const SE2<S>& to, Matrix<S, 3, 3>& J0,
                             Matrix<S, 3, 3>& J1) {
    const SE2<S> relative = from.between(to);
    const Vector<S, 2> p = relative.translation();
    const S c = z.rotation().cosine();
    const S s = z.rotation().sine();
    J0(0, 0) = -c, J0(0, 1) = -s, J0(0, 2) = c * p[1] - s * p[0];
    J0(1, 0) = s, J0(1, 1) = -c, J0(1, 2) = -s * p[1] - c * p[0];
    J0(2, 0) = S(0.0), J0(2, 1) = S(0.0), J0(2, 2) = S(-1.0);
    const S cr = c * relative.rotation().cosine() + s * relative.rotation().sine();
    const S sr = c * relative.rotation().sine() - s * relative.rotation().cosine();
    J1(0, 0) = cr, J1(0, 1) = -sr, J1(0, 2) = S(0.0);
    J1(1, 0) = sr, J1(1, 1) = cr, J1(1, 2) = S(0.0);
    J1(2, 0) = S(0.0), J1(2, 1) = S(0.0), J1(2, 2) = S(1.0);
  }

  /// X₂ = X₁ Z, X₁ = X₂ Z⁻¹.
  static bool initialEstimate(int to, const SE2<double>& z, SE2<double>& first, SE2<double>& second) {
    if (to == 1) {
      second = first * z;
    } else {
      first = second * z.inverse();
    }
    return true;
  }
};

}  // namespace quiver
