#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/addons/vertex_line3d.h>
#include <quiver/types_slam3d/parameter_se3_offset.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// A line seen by a sensor: with L = (X P)⁻¹ L_w in the orthonormal representation, the vector part of the quaternion
/// of U_Lᵀ U_z and the angle of W_Lᵀ W_z (g2o's EDGE_SE3_LINE3D, which loads the offset P and leaves it out).
class EdgeSE3Line3D : public BaseEdge<EdgeSE3Line3D, 4, Vector<double, 6>, VertexSE3, VertexLine3D> {
 public:
  using Parameters = ParameterList<ParameterSE3Offset>;

  template <typename S>
  static Vector<S, 4> computeError(const Vector<S, 6>& z, const SE3<S>& offset, const SE3<S>& pose,
                                   const Vector<S, 6>& line) {
    using std::atan2;
    const detail::OrthonormalLine<S> seen(seenFrom<S>(pose * offset, line)), measured(z);
    Matrix<S, 3, 3> turn;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        turn(r, c) =
            seen.U(0, r) * measured.U(0, c) + seen.U(1, r) * measured.U(1, c) + seen.U(2, r) * measured.U(2, c);
      }
    }
    const SO3<S> q = SO3<S>::fromMatrix(turn);
    const S sign = signOf(q.w());
    return Vector<S, 4>(sign * q.x(), sign * q.y(), sign * q.z(),
                        atan2(S(measured.distance - seen.distance), S(1.0 + measured.distance * seen.distance)));
  }

  /// The line in the sensor's frame follows its pose T = X P by dw = w × φ + d × ρ and dd = d × φ, for a motion (ρ, φ)
  /// of T in its own frame, which is Ad(P⁻¹) of that of X; and its own tangent by those of its frame and distance.
  template <typename S>
  static void linearizeOplus(const Vector<S, 6>& z, const SE3<S>& offset, const SE3<S>& pose, const Vector<S, 6>& line,
                             Matrix<S, 4, 6>& J0, Matrix<S, 4, 4>& J1) {
    const SE3<S> T = pose * offset;
    const Vector<S, 6> seen = seenFrom<S>(T, line);
    const Change<S> change(z, seen);
    const Vector<S, 3> w(seen[0], seen[1], seen[2]), d(seen[3], seen[4], seen[5]);
    Matrix<S, 4, 6> J;
    for (int k = 0; k < 3; ++k) {
      Vector<S, 3> axis(S(0.0), S(0.0), S(0.0));
      axis[k] = S(1.0);
      J.col(k) = change.ofError(cross<S>(d, axis), Vector<S, 3>(S(0.0), S(0.0), S(0.0)));
      J.col(k + 3) = change.ofError(cross<S>(w, axis), cross<S>(d, axis));
    }
    const Matrix<S, 3, 3> back = offset.rotation().inverse().matrix();
    J0.template block<4, 3>(0, 0) = J.template block<4, 3>(0, 0) * back;
    J0.template block<4, 3>(0, 3) = J.template block<4, 3>(0, 3) * back -
                                    J.template block<4, 3>(0, 0) * Matrix<S, 3, 3>(back * hat<S>(offset.translation()));

    const detail::OrthonormalLine<S> own(line);
    const Vector<S, 3> u = own.U.col(0), direction = own.U.col(1), third = own.U.col(2), none = S(0.0) * u;
    const auto ofLine = [&](const Vector<S, 3>& dw, const Vector<S, 3>& dd) {
      const Vector<S, 3> shift = cross<S>(T.translation(), dd);
      return change.ofError(T.rotation().actInverse(Vector<S, 3>(dw - shift)), T.rotation().actInverse(dd));
    };
    J1.col(0) = ofLine(none, third);
    J1.col(1) = ofLine(Vector<S, 3>(-own.distance * third), none);
    J1.col(2) = ofLine(Vector<S, 3>(own.distance * direction), Vector<S, 3>(-u));
    J1.col(3) = ofLine(Vector<S, 3>((1.0 + own.distance * own.distance) * u), none);
  }

  static bool initialEstimate(int to, const Vector<double, 6>& z, const SE3<double>& offset, SE3<double>& pose,
                              Vector<double, 6>& line) {
    if (to != 1) return false;
    line = detail::normalizedLine(seenFrom<double>((pose * offset).inverse(), z));
    return true;
  }

  static std::vector<Field> fields() { return detail::line3dFields(); }
  void read(FieldReader& reader) { setMeasurement(detail::readLine3d(reader)); }
  void write(FieldWriter& writer) const { writer.reals({measurementStore().values(), 6}); }

 private:
  /// How the error follows small changes of the line seen: its frame U turns by ω about its own axes, the quaternion of
  /// U_Lᵀ U_z by −ω from the left.
  template <typename S>
  struct Change {
    detail::OrthonormalLine<S> seen;
    S w;             // of the quaternion with w ≥ 0
    Vector<S, 3> v;  // its vector part
    S inverse;       // 1 / distance; 0 for a line through the origin, whose moment has no direction

    Change(const Vector<S, 6>& z, const Vector<S, 6>& line) : seen(line) {
      const Matrix<S, 3, 3> turn = seen.U.transpose() * detail::OrthonormalLine<S>(z).U;
      const SO3<S> q = SO3<S>::fromMatrix(turn);
      const S sign = signOf(q.w());
      w = sign * q.w();
      v = Vector<S, 3>(sign * q.x(), sign * q.y(), sign * q.z());
      const auto through = seen.distance < S(1e-12);
      inverse = select(through, S(0.0), 1.0 / select(through, S(1.0), seen.distance));
    }
    Vector<S, 4> ofError(const Vector<S, 3>& dw, const Vector<S, 3>& dd) const {
      const Vector<S, 3> u = seen.U.col(0), third = seen.U.col(2);
      const Vector<S, 3> turn(dot<S>(third, dd), -inverse * dot<S>(third, dw), -dot<S>(u, dd));
      const Vector<S, 3> across = cross<S>(v, turn);
      Vector<S, 4> e;
      for (int i = 0; i < 3; ++i) e[i] = -0.5 * (w * turn[i] - across[i]);
      e[3] = -dot<S>(u, dw) / (1.0 + seen.distance * seen.distance);
      return e;
    }
  };

  /// The line in the frame of a pose T: d' = Rᵀ d, w' = Rᵀ (w − t × d).
  template <typename S>
  static Vector<S, 6> seenFrom(const SE3<S>& T, const Vector<S, 6>& line) {
    const Vector<S, 3> d(line[3], line[4], line[5]);
    const Vector<S, 3> shift = cross<S>(T.translation(), d);
    const Vector<S, 3> w =
        T.rotation().actInverse(Vector<S, 3>(line[0] - shift[0], line[1] - shift[1], line[2] - shift[2]));
    const Vector<S, 3> direction = T.rotation().actInverse(d);
    Vector<S, 6> seen;
    for (int i = 0; i < 3; ++i) {
      seen[i] = w[i];
      seen[i + 3] = direction[i];
    }
    return seen;
  }
};

}  // namespace quiver
