#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/vertex_plane.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// The difference of two planes' coefficients: e = (π₂ − π₁) − z, four numbers for three freedoms (g2o's EDGE_PLANE).
class EdgePlane : public BaseEdge<EdgePlane, 4, Vector<double, 4>, VertexPlane, VertexPlane> {
 public:
  template <typename S>
  static Vector<S, 4> computeError(const Vector<S, 4>& z, const Vector<S, 4>& from, const Vector<S, 4>& to) {
    return to - from - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 4>&, const Vector<S, 4>& from, const Vector<S, 4>& to, Matrix<S, 4, 3>& J0,
                             Matrix<S, 4, 3>& J1) {
    step<S>(from, -1.0, J0);
    step<S>(to, 1.0, J1);
  }

  static std::vector<Field> fields() { return {{"a", "", ""}, {"b", "", ""}, {"c", "", ""}, {"d", "m", ""}}; }

 private:
  /// ∂π/∂δ: the normal moves along its frame's second and third axis, d against the distance.
  template <typename S>
  static void step(const Vector<S, 4>& plane, double sign, Matrix<S, 4, 3>& J) {
    const Matrix<S, 3, 3> R = detail::normalFrame<S>(Vector<S, 3>(plane[0], plane[1], plane[2]));
    for (int r = 0; r < 3; ++r) {
      J(r, 0) = sign * R(r, 1);
      J(r, 1) = sign * R(r, 2);
      J(r, 2) = S(0.0);
    }
    J(3, 0) = J(3, 1) = S(0.0), J(3, 2) = S(-sign);
  }
};

/// A plane seen by a sensor whose pose O in the body is estimated: with π = (X O)⁻¹ π_w, the azimuth and elevation of
/// the measured normal in the frame of the seen one, and the seen distance less the measured (g2o's
/// EDGE_SE3_PLANE_CALIB). The measurement is a b c d and the colour.
class EdgeSE3Plane : public BaseEdge<EdgeSE3Plane, 3, Vector<double, 7>, VertexSE3, VertexPlane, VertexSE3> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 7>& z, const SE3<S>& pose, const Vector<S, 4>& plane,
                                   const SE3<S>& sensor) {
    using std::atan2, std::sqrt;
    const SE3<S> eye = pose * sensor;
    const Vector<S, 3> normal(plane[0], plane[1], plane[2]);
    const Matrix<S, 3, 3> R = detail::normalFrame<S>(eye.rotation().actInverse(normal));
    const S distance = -plane[3] - dot<S>(normal, eye.translation());
    S n[3];
    for (int i = 0; i < 3; ++i) n[i] = R(0, i) * z[0] + R(1, i) * z[1] + R(2, i) * z[2];
    return Vector<S, 3>(atan2(n[1], n[0]), atan2(n[2], S(sqrt(n[0] * n[0] + n[1] * n[1]))), S(distance + z[3]));
  }

  static bool initialEstimate(int to, const Vector<double, 7>& z, SE3<double>& pose, Vector<double, 4>& plane,
                              SE3<double>& sensor) {
    if (to != 1) return false;
    const SE3<double> eye = pose * sensor;
    const Vector<double, 3> normal = eye.rotation() * Vector<double, 3>(z.head<3>());
    plane << normal, z[3] - normal.dot(eye.translation());
    return true;
  }

  static std::vector<Field> fields() { return detail::planeFields(); }
  void read(FieldReader& reader) {
    Vector<double, 7> z;
    z.head<4>() = detail::readPlane(reader);
    reader.reals({z.data() + 4, 3});
    setMeasurement(z);
  }
  void write(FieldWriter& writer) const { writer.reals({measurementStore().values(), 7}); }
};

}  // namespace quiver
