#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/addons/vertex_line2d.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {

namespace detail {
inline std::vector<Field> lineFields() {
  return {{"theta", "rad", "direction of the normal"}, {"rho", "m", "distance along the normal"}};
}
}  // namespace detail

/// A line seen from a pose: (wrap(θ − θ_X − z_θ), ρ − n(θ)·t − z_ρ) (g2o's EDGE_SE2_LINE2D).
class EdgeSE2Line2D : public BaseEdge<EdgeSE2Line2D, 2, Vector<double, 2>, VertexSE2, VertexLine2D> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& pose, const Vector<S, 2>& line) {
    const SinCos<S> n = sincos(line[0]);
    return Vector<S, 2>(wrapAngle(S(line[0] - pose.angle() - z[0])),
                        line[1] - (n.cosine * pose.x() + n.sine * pose.y()) - z[1]);
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE2<S>& pose, const Vector<S, 2>& line, Matrix<S, 2, 3>& J0,
                             Matrix<S, 2, 2>& J1) {
    const SinCos<S> n = sincos(line[0]);
    const Vector<S, 2> seen = pose.rotation().actInverse(Vector<S, 2>(n.cosine, n.sine));
    J0(0, 0) = J0(0, 1) = S(0.0), J0(0, 2) = S(-1.0);
    J0(1, 0) = -seen[0], J0(1, 1) = -seen[1], J0(1, 2) = S(0.0);
    J1(0, 0) = S(1.0), J1(0, 1) = S(0.0);
    J1(1, 0) = n.sine * pose.x() - n.cosine * pose.y(), J1(1, 1) = S(1.0);
  }

  static bool initialEstimate(int to, const Vector<double, 2>& z, SE2<double>& pose, Vector<double, 2>& line) {
    if (to != 1) return false;
    line[0] = wrapAngle(z[0] + pose.angle());
    line[1] = z[1] + std::cos(line[0]) * pose.x() + std::sin(line[0]) * pose.y();
    return true;
  }

  static std::vector<Field> fields() { return detail::lineFields(); }
};

/// The difference of two lines' coordinates: e = (l₂ − l₁) − z with the angle wrapped (g2o's EDGE_LINE2D leaves it
/// unwrapped).
class EdgeLine2D : public BaseEdge<EdgeLine2D, 2, Vector<double, 2>, VertexLine2D, VertexLine2D> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& from, const Vector<S, 2>& to) {
    return Vector<S, 2>(wrapAngle(S(to[0] - from[0] - z[0])), to[1] - from[1] - z[1]);
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 2>&, const Vector<S, 2>&, Matrix<S, 2, 2>& J0,
                             Matrix<S, 2, 2>& J1) {
    J0 = -Matrix<S, 2, 2>::Identity();
    J1.setIdentity();
  }

  static bool initialEstimate(int to, const Vector<double, 2>& z, Vector<double, 2>& first, Vector<double, 2>& second) {
    if (to == 1) {
      second = Vector<double, 2>(wrapAngle(first[0] + z[0]), first[1] + z[1]);
    } else {
      first = Vector<double, 2>(wrapAngle(second[0] - z[0]), second[1] - z[1]);
    }
    return true;
  }

  static std::vector<Field> fields() { return detail::lineFields(); }
};

/// A point at a signed distance from a line: e = n(θ)·p − ρ − d (g2o's EDGE_LINE2D_POINTXY).
class EdgeLine2DXY : public BaseEdge<EdgeLine2DXY, 1, double, VertexLine2D, VertexXY> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& z, const Vector<S, 2>& line, const Vector<S, 2>& point) {
    const SinCos<S> n = sincos(line[0]);
    return Vector<S, 1>(S(n.cosine * point[0] + n.sine * point[1] - line[1] - z));
  }

  template <typename S>
  static void linearizeOplus(const S&, const Vector<S, 2>& line, const Vector<S, 2>& point, Matrix<S, 1, 2>& J0,
                             Matrix<S, 1, 2>& J1) {
    const SinCos<S> n = sincos(line[0]);
    J0(0, 0) = n.cosine * point[1] - n.sine * point[0], J0(0, 1) = S(-1.0);
    J1(0, 0) = n.cosine, J1(0, 1) = n.sine;
  }

  static std::vector<Field> fields() { return {{"distance", "m", "along the line's normal"}}; }
};

}  // namespace quiver
