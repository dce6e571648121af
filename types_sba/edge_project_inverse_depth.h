#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/expmap/parameter_camera_parameters.h>
#include <quiver/types_sba/expmap/vertex_se3_expmap.h>
#include <quiver/types_sba/vertex_inverse_depth.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

namespace detail {

/// What the edges on anchored points share: e = z − π(p), p = X⁻¹ A y with y = (ψ₁, ψ₂, 1) / ψ₃ in the anchor A.
/// Computed from ψ₃ p, which has the same pixel and is finite for points at infinity.
template <typename Edge, typename Point, typename Pose>
class AnchoredProjection : public BaseEdge<Edge, 2, Vector<double, 2>, Point, Pose, Pose> {
 public:
  using Parameters = ParameterList<ParameterCameraParameters>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 4>& k, const Vector<S, 3>& psi,
                                   const SE3<S>& pose, const SE3<S>& anchor) {
    return difference<S, 2>(z, stereoCamera<S>(k).template project<2>(scaledPoint<S>(psi, pose.between(anchor))));
  }

  /// With q = ψ₃ p, N = ∂e/∂q, R = R_Xᵀ R_A, c = X⁻¹ t_A and y' = (ψ₁, ψ₂, 1): N [R e₁, R e₂, c] by ψ,
  /// N [−ψ₃ I, [q]ₓ] by the pose, N R [ψ₃ I, −[y']ₓ] by the anchor.
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 4>& k, const Vector<S, 3>& psi, const SE3<S>& pose,
                             const SE3<S>& anchor, Matrix<S, 2, 3>& J0, Matrix<S, 2, 6>& J1, Matrix<S, 2, 6>& J2) {
    const SE3<S> way = pose.between(anchor);
    const Vector<S, 3> q = scaledPoint<S>(psi, way), c = way.translation();
    const Matrix<S, 3, 3> R = way.rotation().matrix();
    const Matrix<S, 2, 3> N = stereoCamera<S>(k).template pointJacobian<2>(q, -1.0);
    seenPointByPose<S, 2>(N, q, J1);
    QUIVER_UNROLL for (int r = 0; r < 2; ++r) {
      S turned[3];
      QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
        turned[i] = N(r, 0) * R(0, i) + N(r, 1) * R(1, i) + N(r, 2) * R(2, i);
        J1(r, i) *= psi[2];
        J2(r, i) = psi[2] * turned[i];
      }
      J0(r, 0) = turned[0];
      J0(r, 1) = turned[1];
      J0(r, 2) = N(r, 0) * c[0] + N(r, 1) * c[1] + N(r, 2) * c[2];
      J2(r, 3) = turned[2] * psi[1] - turned[1];
      J2(r, 4) = turned[0] - turned[2] * psi[0];
      J2(r, 5) = turned[1] * psi[0] - turned[0] * psi[1];
    }
  }

  /// In front of both the camera and the anchor.
  static bool isDepthPositive(const Vector<double, 2>&, const Vector<double, 4>&, const Vector<double, 3>& psi,
                              const SE3<double>& pose, const SE3<double>& anchor) {
    return psi[2] > 0.0 && scaledPoint<double>(psi, pose.between(anchor))[2] > 0.0;
  }
  static std::vector<Field> fields() { return pixelFields<2>(); }

 private:
  template <typename S>
  static Vector<S, 3> scaledPoint(const Vector<S, 3>& psi, const SE3<S>& way) {
    const Vector<S, 3> turned = way.rotation() * Vector<S, 3>(psi[0], psi[1], S(1.0)), c = way.translation();
    return Vector<S, 3>(turned[0] + psi[2] * c[0], turned[1] + psi[2] * c[1], turned[2] + psi[2] * c[2]);
  }
};

}  // namespace detail

/// A pixel of a point that is anchored in another camera; the point, the camera, the anchor (g2o's
/// EDGE_PROJECT_PSI2UV:EXPMAP, whose points are VERTEX_TRACKXYZ that hold (x/z, y/z, 1/z)). Since those points claim to
/// lie in the world, their free directions cannot be told; EdgeProjectInverseDepth is better off.
class EdgeProjectPSI2UV : public detail::AnchoredProjection<EdgeProjectPSI2UV, VertexXYZ, VertexSE3Expmap> {};

/// A pixel of an anchored point: the point, the pose that sees it, the pose it is anchored in. The anchor's own view of
/// it is EdgeProjectInverseDepthAnchor.
class EdgeProjectInverseDepth
    : public detail::AnchoredProjection<EdgeProjectInverseDepth, VertexInverseDepth, VertexSE3> {};

/// The pixel of an anchored point in its anchor: e = z − (f ψ₁ + cx, f ψ₂ + cy).
class EdgeProjectInverseDepthAnchor
    : public BaseEdge<EdgeProjectInverseDepthAnchor, 2, Vector<double, 2>, VertexInverseDepth> {
 public:
  using Parameters = ParameterList<ParameterCameraParameters>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 4>& k, const Vector<S, 3>& psi) {
    return Vector<S, 2>(z[0] - (k[0] * psi[0] + k[1]), z[1] - (k[0] * psi[1] + k[2]));
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 4>& k, const Vector<S, 3>&, Matrix<S, 2, 3>& J) {
    J(0, 0) = J(1, 1) = -k[0];
    J(0, 1) = J(0, 2) = J(1, 0) = J(1, 2) = S(0.0);
  }
  static bool isDepthPositive(const Vector<double, 2>&, const Vector<double, 4>&, const Vector<double, 3>& psi) {
    return psi[2] > 0.0;
  }
  static std::vector<Field> fields() { return detail::pixelFields<2>(); }
};

}  // namespace quiver
