#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/addons/vertex_plane.h>
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

  /// With m the seen normal, p that in the body, G = ∂(azimuth, elevation)/∂m: rows G ∂m, where ∂m is R_Oᵀ [p]ₓ φ by
  /// the pose, [m]ₓ φ by the sensor and R_eyeᵀ times the normal's frame by the plane; below them the distance −d −
  /// n·t_eye.
  template <typename S>
  static void linearizeOplus(const Vector<S, 7>& z, const SE3<S>& pose, const Vector<S, 4>& plane, const SE3<S>& sensor,
                             Matrix<S, 3, 6>& J0, Matrix<S, 3, 3>& J1, Matrix<S, 3, 6>& J2) {
    const SE3<S> eye = pose * sensor;
    const Vector<S, 3> normal(plane[0], plane[1], plane[2]);
    const Vector<S, 3> p = pose.rotation().actInverse(normal), m = eye.rotation().actInverse(normal);
    const Matrix<S, 2, 3> G = anglesByNormal<S>(z, m);
    const Matrix<S, 2, 3> byBody = G * sensor.rotation().matrix().transpose();
    const Vector<S, 3> lever = cross<S>(sensor.translation(), p), zero(S(0.0), S(0.0), S(0.0));
    poseBlock<S>(byBody, p, lever, J0);
    poseBlock<S>(G, m, zero, J2);
    const Matrix<S, 3, 3> frame = detail::normalFrame<S>(normal);
    for (int c = 0; c < 2; ++c) {
      const Vector<S, 3> across(frame(0, c + 1), frame(1, c + 1), frame(2, c + 1));
      const Vector<S, 3> seen = eye.rotation().actInverse(across);
      for (int r = 0; r < 2; ++r) J1(r, c) = G(r, 0) * seen[0] + G(r, 1) * seen[1] + G(r, 2) * seen[2];
      J1(2, c) = -dot<S>(across, eye.translation());
      J1(c, 2) = S(0.0);
    }
    J1(2, 2) = S(1.0);
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

 private:
  /// ∂(azimuth, elevation)/∂m of the measured normal in the frame (m, a, b) of the seen one, a = (−s, c, 0): with
  /// n = (m·z, a·z, b·z), ∂n is (z·∂m, −q a·∂m/h, −q ∂m_z − m_z (a·z) a·∂m/h + z_z ∂h), q = c z_x + s z_y, h = |m_xy|.
  template <typename S>
  static Matrix<S, 2, 3> anglesByNormal(const Vector<S, 7>& z, const Vector<S, 3>& m) {
    using std::sqrt;
    const Matrix<S, 3, 3> R = detail::normalFrame<S>(m);
    const S h = R(2, 2), s = -R(0, 1), c = R(1, 1), q = c * z[0] + s * z[1];
    S n[3];
    for (int i = 0; i < 3; ++i) n[i] = R(0, i) * z[0] + R(1, i) * z[1] + R(2, i) * z[2];
    const S flat = n[0] * n[0] + n[1] * n[1];
    // At the poles the frame turns at any speed; what that does to the error is a product with the error itself.
    const auto pole = h < S(1e-12);
    const S rate = select(pole, S(0.0), S(S(1.0) / select(pole, S(1.0), h)));
    const S a[3] = {S(-s * rate), S(c * rate), S(0.0)}, level[3] = {c, s, S(0.0)}, up[3] = {S(0.0), S(0.0), S(1.0)};
    Matrix<S, 2, 3> G;
    for (int i = 0; i < 3; ++i) {
      const S dn0 = z[i], dn1 = -q * a[i];
      const S dn2 = z[2] * level[i] - q * up[i] - m[2] * n[1] * a[i];
      G(0, i) = (n[0] * dn1 - n[1] * dn0) / flat;
      G(1, i) = (flat * dn2 - n[2] * (n[0] * dn0 + n[1] * dn1)) / ((flat + n[2] * n[2]) * sqrt(flat));
    }
    return G;
  }
  /// [0, G [n]ₓ; −nᵀ, −leverᵀ]
  template <typename S>
  static void poseBlock(const Matrix<S, 2, 3>& G, const Vector<S, 3>& n, const Vector<S, 3>& lever,
                        Matrix<S, 3, 6>& J) {
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 3; ++c) J(r, c) = S(0.0);
      J(r, 3) = G(r, 1) * n[2] - G(r, 2) * n[1];
      J(r, 4) = G(r, 2) * n[0] - G(r, 0) * n[2];
      J(r, 5) = G(r, 0) * n[1] - G(r, 1) * n[0];
    }
    for (int c = 0; c < 3; ++c) {
      J(2, c) = -n[c];
      J(2, c + 3) = -lever[c];
    }
  }
};

}  // namespace quiver
