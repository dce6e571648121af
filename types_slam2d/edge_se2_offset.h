#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/parameter_se2_offset.h>
#include <quiver/types_slam2d/point_jacobian.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {

/// The pose of one sensor seen from another: e = Z⁻¹ (X₁ P₁)⁻¹ (X₂ P₂) as (x, y, θ) (g2o's EDGE_SE2_OFFSET).
class EdgeSE2Offset : public BaseEdge<EdgeSE2Offset, 3, SE2<double>, VertexSE2, VertexSE2> {
 public:
  using Parameters = ParameterList<ParameterSE2Offset, ParameterSE2Offset>;

  template <typename S>
  static Vector<S, 3> computeError(const SE2<S>& z, const SE2<S>& fromOffset, const SE2<S>& toOffset,
                                   const SE2<S>& from, const SE2<S>& to) {
    return z.between((from * fromOffset).between(to * toOffset)).toVector();
  }

  /// A motion δ between A and B moves the product A B by [R_A, R_A J t_B; 0, 1] δ, J the quarter turn; here A is
  /// (P₁ Z)⁻¹ with −δ and Z⁻¹ (X₁ P₁)⁻¹ X₂.
  template <typename S>
  static void linearizeOplus(const SE2<S>& z, const SE2<S>& fromOffset, const SE2<S>& toOffset, const SE2<S>& from,
                             const SE2<S>& to, Matrix<S, 3, 3>& J0, Matrix<S, 3, 3>& J1) {
    const SO2<S> A0 = (fromOffset.rotation() * z.rotation()).inverse();
    const SO2<S> A1 = A0 * (from.rotation().inverse() * to.rotation());
    block<S>(A0, from.actInverse(to * toOffset.translation()), -1.0, J0);
    block<S>(A1, toOffset.translation(), 1.0, J1);
  }

  static bool initialEstimate(int to, const SE2<double>& z, const SE2<double>& fromOffset, const SE2<double>& toOffset,
                              SE2<double>& first, SE2<double>& second) {
    if (to == 1) {
      second = first * fromOffset * z * toOffset.inverse();
    } else {
      first = second * toOffset * z.inverse() * fromOffset.inverse();
    }
    return true;
  }

 private:
  template <typename S>
  static void block(const SO2<S>& A, const Vector<S, 2>& b, double sign, Matrix<S, 3, 3>& J) {
    const S c = sign * A.cosine(), s = sign * A.sine();
    J(0, 0) = c, J(0, 1) = -s, J(0, 2) = -c * b[1] - s * b[0];
    J(1, 0) = s, J(1, 1) = c, J(1, 2) = c * b[0] - s * b[1];
    J(2, 0) = J(2, 1) = S(0.0), J(2, 2) = S(sign);
  }
};

/// A point seen by a sensor: e = (X P)⁻¹ l − z (g2o's EDGE_SE2_POINTXY_OFFSET, which leaves P out of the error).
class EdgeSE2XYOffset : public BaseEdge<EdgeSE2XYOffset, 2, Vector<double, 2>, VertexSE2, VertexXY> {
 public:
  using Parameters = ParameterList<ParameterSE2Offset>;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& offset, const SE2<S>& pose,
                                   const Vector<S, 2>& point) {
    return offset.actInverse(pose.actInverse(point)) - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE2<S>& offset, const SE2<S>& pose, const Vector<S, 2>& point,
                             Matrix<S, 2, 3>& J0, Matrix<S, 2, 2>& J1) {
    detail::turnedPointByPose<S>(offset.rotation(), pose.actInverse(point), J0);
    detail::transposedRotation<S>(pose.rotation() * offset.rotation(), J1);
  }

  static bool initialEstimate(int to, const Vector<double, 2>& z, const SE2<double>& offset, SE2<double>& pose,
                              Vector<double, 2>& point) {
    if (to != 1) return false;
    point = pose * (offset * z);
    return true;
  }
};

/// A point seen by a sensor whose pose C in the body is estimated: e = (X C)⁻¹ l − z (g2o's EDGE_SE2_XY_CALIB).
class EdgeSE2XYCalibration
    : public BaseEdge<EdgeSE2XYCalibration, 2, Vector<double, 2>, VertexSE2, VertexXY, VertexSE2> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& pose, const Vector<S, 2>& point,
                                   const SE2<S>& sensor) {
    return sensor.actInverse(pose.actInverse(point)) - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE2<S>& pose, const Vector<S, 2>& point, const SE2<S>& sensor,
                             Matrix<S, 2, 3>& J0, Matrix<S, 2, 2>& J1, Matrix<S, 2, 3>& J2) {
    const Vector<S, 2> p = pose.actInverse(point);
    detail::turnedPointByPose<S>(sensor.rotation(), p, J0);
    detail::transposedRotation<S>(pose.rotation() * sensor.rotation(), J1);
    detail::seenPointByPose<S>(sensor.actInverse(p), J2);
  }

  static bool initialEstimate(int to, const Vector<double, 2>& z, SE2<double>& pose, Vector<double, 2>& point,
                              SE2<double>& sensor) {
    if (to != 1) return false;
    point = pose * (sensor * z);
    return true;
  }
};

}  // namespace quiver
