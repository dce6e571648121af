#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {

/// The direction in which a pose sees a point: e = wrap(z − atan2(X⁻¹ l)), measured less predicted (g2o's
/// EDGE_BEARING_SE2_XY). Infinite Jacobian where the point lies on the pose.
class EdgeBearingSE2XY : public BaseEdge<EdgeBearingSE2XY, 1, double, VertexSE2, VertexXY> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 1> computeError(const S& z, const SE2<S>& pose, const Vector<S, 2>& point) {
    using std::atan2;
    const Vector<S, 2> p = pose.actInverse(point);
    return Vector<S, 1>(wrapAngle(S(z - atan2(p[1], p[0]))));
  }

  /// With p = X⁻¹ l: [−p_y, p_x, |p|²] / |p|² by the pose, (p_y, −p_x) Rᵀ / |p|² by the point.
  template <typename S>
  static void linearizeOplus(const S&, const SE2<S>& pose, const Vector<S, 2>& point, Matrix<S, 1, 3>& J0,
                             Matrix<S, 1, 2>& J1) {
    const Vector<S, 2> p = pose.actInverse(point);
    const S scale = 1.0 / (p[0] * p[0] + p[1] * p[1]);
    const S x = scale * p[0], y = scale * p[1];
    const S &c = pose.rotation().cosine(), &s = pose.rotation().sine();
    J0(0, 0) = -y, J0(0, 1) = x, J0(0, 2) = S(1.0);
    J1(0, 0) = y * c + x * s, J1(0, 1) = y * s - x * c;
  }

  /// The range is unknown: the point is put at 2 m, as g2o does.
  static bool initialEstimate(int to, const double& z, SE2<double>& pose, Vector<double, 2>& point) {
    if (to != 1) return false;
    constexpr double range = 2.0;
    point = pose * Vector<double, 2>(range * std::cos(z), range * std::sin(z));
    return true;
  }

  static std::vector<Field> fields() { return {{"bearing", "rad", "counter-clockwise from the body's x axis"}}; }
};

}  // namespace quiver
