#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/parameter_se3_offset.h>
#include <quiver/types_slam3d/quaternion_error.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// The pose of one sensor seen from another: e = (t, q_xyz) of Z⁻¹ (X₁ P₁)⁻¹ (X₂ P₂) (g2o's EDGE_SE3_OFFSET).
class EdgeSE3Offset : public BaseEdge<EdgeSE3Offset, 6, SE3<double>, VertexSE3, VertexSE3> {
 public:
  using Parameters = ParameterList<ParameterSE3Offset, ParameterSE3Offset>;
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& fromOffset, const SE3<S>& toOffset,
                                   const SE3<S>& from, const SE3<S>& to) {
    return detail::quaternionError<S>((fromOffset * z).between(from.between(to * toOffset)));
  }

  /// D = (P₁ Z)⁻¹ Exp(−δ₁) X₁⁻¹ X₂ P₂ = (P₁ Z)⁻¹ X₁⁻¹ X₂ Exp(δ₂) P₂.
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& fromOffset, const SE3<S>& toOffset, const SE3<S>& from,
                             const SE3<S>& to, Matrix<S, 6, 6>& J0, Matrix<S, 6, 6>& J1) {
    const SE3<S> A = fromOffset * z;
    const SE3<S> B = from.between(to);
    const SE3<S> C = B * toOffset;
    const SE3<S> D = A.between(C);
    detail::quaternionErrorByInverse<S>(D, A.rotation().inverse().matrix(), C.translation(), J0);
    detail::quaternionErrorByMiddle<S>(D, (A.rotation().inverse() * B.rotation()).matrix(), toOffset.translation(), J1);
  }

  static bool initialEstimate(int to, const SE3<double>& z, const SE3<double>& fromOffset, const SE3<double>& toOffset,
                              SE3<double>& first, SE3<double>& second) {
    if (to == 1) {
      second = first * fromOffset * z * toOffset.inverse();
    } else {
      first = second * toOffset * z.inverse() * fromOffset.inverse();
    }
    return true;
  }
};

/// The motion of a sensor whose pose C in the body is estimated: e = (t, q_xyz) of Z⁻¹ (X₁ C)⁻¹ (X₂ C) (g2o's
/// EDGE_SE3_CALIB).
class EdgeSE3Calibration : public BaseEdge<EdgeSE3Calibration, 6, SE3<double>, VertexSE3, VertexSE3, VertexSE3> {
 public:
  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to, const SE3<S>& sensor) {
    return detail::quaternionError<S>((sensor * z).between(from.between(to * sensor)));
  }

  /// The sensor's motion enters twice: D = Z⁻¹ Exp(−δ) C⁻¹ X₁⁻¹ X₂ C, and D Exp(δ).
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to, const SE3<S>& sensor,
                             Matrix<S, 6, 6>& J0, Matrix<S, 6, 6>& J1, Matrix<S, 6, 6>& J2) {
    const SE3<S> A = sensor * z;
    const SE3<S> B = from.between(to);
    const SE3<S> C = B * sensor;
    const SE3<S> D = A.between(C);
    detail::quaternionErrorByInverse<S>(D, A.rotation().inverse().matrix(), C.translation(), J0);
    detail::quaternionErrorByMiddle<S>(D, (A.rotation().inverse() * B.rotation()).matrix(), sensor.translation(), J1);
    Matrix<S, 6, 6> right;
    detail::quaternionErrorByInverse<S>(D, z.rotation().inverse().matrix(), sensor.between(C).translation(), J2);
    detail::quaternionErrorByRight<S>(D, right);
    for (int c = 0; c < 6; ++c) {
      for (int r = 0; r < 6; ++r) J2(r, c) += right(r, c);
    }
  }

  static bool initialEstimate(int to, const SE3<double>& z, SE3<double>& first, SE3<double>& second,
                              SE3<double>& sensor) {
    if (to == 2) return false;
    if (to == 1) {
      second = first * sensor * z * sensor.inverse();
    } else {
      first = second * sensor * z.inverse() * sensor.inverse();
    }
    return true;
  }
};

}  // namespace quiver
