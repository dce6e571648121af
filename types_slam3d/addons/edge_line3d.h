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
