#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/expmap/vertex_se3_expmap.h>

namespace quiver {

/// The pose Z of the second camera seen from the first; e = (φ, ρ), rotation first, of ln(X₂ Z⁻¹ X₁⁻¹) in the world's
/// axes (g2o's EDGE_SE3:EXPMAP: ln(T₂⁻¹ C T₁) with T = X⁻¹ and C = Z⁻¹).
class EdgeSE3Expmap : public BaseEdge<EdgeSE3Expmap, 6, SE3<double>, VertexSE3Expmap, VertexSE3Expmap> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& first, const SE3<S>& second) {
    const Vector<S, 6> v = (second * (first * z).inverse()).log();
    Vector<S, 6> e;
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
      e[i] = v[i + 3];
      e[i + 3] = v[i];
    }
    return e;
  }

  /// ln(E Exp(ξ)) ≈ e + J_r⁻¹(e) ξ with ξ = −Ad(X₁) δ₁ and ξ = Ad(X₁ Z) δ₂.
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& first, const SE3<S>& second, Matrix<S, 6, 6>& J0,
                             Matrix<S, 6, 6>& J1) {
    const SE3<S> there = first * z;
    const Matrix<S, 6, 6> J = SE3<S>::rightJacobianInverse((second * there.inverse()).log());
    product<S>(J, first.adjoint(), -1.0, J0);
    product<S>(J, there.adjoint(), 1.0, J1);
  }

  static bool initialEstimate(int to, const SE3<double>& z, SE3<double>& first, SE3<double>& second) {
    if (to == 1) {
      second = first * z;
    } else {
      first = second * z.inverse();
    }
    return true;
  }

 private:
  /// sign · J Ad for J = [A B; 0 A] and Ad = [R t^R; 0 R], with the rows of the rotation first.
  template <typename S>
  static void product(const Matrix<S, 6, 6>& J, const Matrix<S, 6, 6>& Ad, double sign, Matrix<S, 6, 6>& result) {
    QUIVER_UNROLL for (int r = 0; r < 3; ++r) {
      QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
        const S turn = J(r, 0) * Ad(0, c) + J(r, 1) * Ad(1, c) + J(r, 2) * Ad(2, c);
        const S swing = J(r, 0) * Ad(0, c + 3) + J(r, 1) * Ad(1, c + 3) + J(r, 2) * Ad(2, c + 3);
        const S tilt = J(r, 3) * Ad(0, c) + J(r, 4) * Ad(1, c) + J(r, 5) * Ad(2, c);
        result(r + 3, c) = sign * turn;
        result(r + 3, c + 3) = sign * (swing + tilt);
        result(r, c) = S(0.0);
        result(r, c + 3) = sign * turn;
      }
    }
  }
};

}  // namespace quiver
