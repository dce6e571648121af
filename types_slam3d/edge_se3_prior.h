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

/// A sensor's position measured in the world: e = X t_P − z, t_P the sensor in the body (g2o's EDGE_SE3_XYZ_PRIOR,
/// which asks for the offset and leaves it out).
class EdgeSE3XYZPrior : public BaseEdge<EdgeSE3XYZPrior, 3, Vector<double, 3>, VertexSE3> {
 public:
  using Parameters = ParameterList<ParameterSE3Offset>;

  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 3>& z, const SE3<S>& offset, const SE3<S>& x) {
    return x * offset.translation() - z;
  }

  /// [R, −R [t_P]ₓ]
  template <typename S>
  static void linearizeOplus(const Vector<S, 3>&, const SE3<S>& offset, const SE3<S>& x, Matrix<S, 3, 6>& J) {
    const Matrix<S, 3, 3> R = x.rotation().matrix();
    const Matrix<S, 3, 3> swing = detail::timesHat<S>(R, offset.translation());
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) {
        J(r, c) = R(r, c);
        J(r, c + 3) = -swing(r, c);
      }
    }
  }
};

}  // namespace quiver
