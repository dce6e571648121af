#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

namespace detail {

/// What the two logarithmic edges share. `exact` decides between J_r⁻¹(e) and I + ½ [φ^ ρ^; 0 φ^].
template <typename Edge, bool exact>
class LogarithmicEdge : public BaseEdge<Edge, 6, SE3<double>, VertexSE3, VertexSE3> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to) {
    return z.between(from.between(to)).log();
  }

  /// J₂ = J_r⁻¹(e), J₁ = −J_r⁻¹(e) Ad(X₂⁻¹ X₁).
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to, Matrix<S, 6, 6>& J0,
                             Matrix<S, 6, 6>& J1) {
    const SE3<S> E = from.between(to);
    const Vector<S, 6> e = z.between(E).log();
    if constexpr (exact) {
      J1 = SE3<S>::rightJacobianInverse(e);
    } else {
      J1 = SE3<S>::rightJacobianInverseApproximation(e);
    }
    timesAdjoint<S>(J1, E.inverse(), J0);
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

 private:
  /// −J Ad(X) for J = [A B; 0 A] and Ad = [R t^R; 0 R].
  template <typename S>
  static void timesAdjoint(const Matrix<S, 6, 6>& J, const SE3<S>& X, Matrix<S, 6, 6>& result) {
    const Matrix<S, 6, 6> Ad = X.adjoint();
    QUIVER_UNROLL for (int r = 0; r < 3; ++r) {
      QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
        const S turn = -(J(r, 0) * Ad(0, c) + J(r, 1) * Ad(1, c) + J(r, 2) * Ad(2, c));
        const S swing = J(r, 0) * Ad(0, c + 3) + J(r, 1) * Ad(1, c + 3) + J(r, 2) * Ad(2, c + 3);
        result(r, c) = result(r + 3, c + 3) = turn;
        result(r, c + 3) = -(swing + (J(r, 3) * Ad(0, c) + J(r, 4) * Ad(1, c) + J(r, 5) * Ad(2, c)));
        result(r + 3, c) = S(0.0);
      }
    }
  }
};

}  // namespace detail

/// The pose-graph edge of the SLAM lectures: e = ln(Z⁻¹ X₁⁻¹ X₂)ᵛ as (ρ, φ), with the exact inverse right Jacobian.
class EdgeSE3Log : public detail::LogarithmicEdge<EdgeSE3Log, true> {};

/// The same error with J_r⁻¹ ≈ I + ½ [φ^ ρ^; 0 φ^], right to first order in e: to compare. Its Jacobian is not the
/// error's derivative, so the point it converges to differs from the optimum by terms of second order in the residuals.
class EdgeSE3LogApproximate : public detail::LogarithmicEdge<EdgeSE3LogApproximate, false> {};

}  // namespace quiver
