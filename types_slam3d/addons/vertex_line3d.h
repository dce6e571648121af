#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/se3.h>

namespace quiver {

namespace detail {

/// The orthonormal representation of a line (w, d), |d| = 1: the frame U = (w/|w|, d, w/|w| × d) and the angle of W
/// with tan = |w|, the distance from the origin. For a line through the origin the first axis is any one across d.
template <typename S>
struct OrthonormalLine {
  Matrix<S, 3, 3> U;
  S distance;

  explicit OrthonormalLine(const Vector<S, 6>& line) {
    using std::abs, std::sqrt;
    const Vector<S, 3> w(line[0], line[1], line[2]), d(line[3], line[4], line[5]);
    const S square = dot<S>(w, w);
    const auto through = square < S(1e-24);
    distance = select(through, S(0.0), sqrt(select(through, S(1.0), square)));
    const auto steep = abs(d[2]) > S(0.7);
    const Vector<S, 3> other =
        cross<S>(d, Vector<S, 3>(select(steep, S(1.0), S(0.0)), S(0.0), select(steep, S(0.0), S(1.0))));
    Vector<S, 3> u;
    for (int i = 0; i < 3; ++i) u[i] = select(through, other[i], w[i]);
    const S scale = 1.0 / sqrt(dot<S>(u, u));
    for (int i = 0; i < 3; ++i) u[i] = scale * u[i];
    const Vector<S, 3> third = cross<S>(u, d);
    for (int i = 0; i < 3; ++i) {
      U(i, 0) = u[i];
      U(i, 1) = d[i];
      U(i, 2) = third[i];
    }
  }
};

/// Makes d a unit vector and w orthogonal to it; bits are kept where that holds to 1e-14.
inline Vector<double, 6> normalizedLine(Vector<double, 6> line) {
  const double square = line.tail<3>().squaredNorm();
  if (std::abs(square - 1.0) > 1e-14) line /= std::sqrt(square);
  // Where w is nearly along d, what is left of it needs a second pass.
  for (int pass = 0; pass < 3; ++pass) {
    const double along = line.head<3>().dot(line.tail<3>());
    if (std::abs(along) <= 1e-14 * line.head<3>().norm()) break;
    line.head<3>() -= along * line.tail<3>();
  }
  return line;
}

inline std::vector<Field> line3dFields() {
  return {{"w1", "m", "moment p x d"},  {"w2", "m", ""}, {"w3", "m", ""},
          {"d1", "", "unit direction"}, {"d2", "", ""},  {"d3", "", ""}};
}

inline Vector<double, 6> readLine3d(FieldReader& reader) {
  Vector<double, 6> line;
  reader.reals({line.data(), 6});
  if (!(line.tail<3>().squaredNorm() > 1e-24)) reader.fail("a line's direction must not be zero");
  return normalizedLine(line);
}

}  // namespace detail

/// A line in space by Plücker's coordinates (w, d): moment w = p × d and unit direction d. Tangent: the frame
/// (w/|w|, d, w/|w| × d) turns by three angles about its own axes, and the angle with tan = |w| grows by the fourth.
class VertexLine3D : public BaseVertex<VertexLine3D, 4, Vector<double, 6>> {
 public:
  static constexpr std::array tangent{"turn about moment [rad]", "turn about line [rad]", "turn about third axis [rad]",
                                      "distance angle [rad]"};

  template <typename S>
  static Vector<S, 6> oplus(const Vector<S, 6>& x, const Vector<S, 4>& delta) {
    const detail::OrthonormalLine<S> line(x);
    const Matrix<S, 3, 3> turn = SO3<S>::exp(Vector<S, 3>(delta[0], delta[1], delta[2])).matrix();
    const SinCos<S> angle = sincos(delta[3]);
    // tan(a + δ) from tan a: sine and cosine up to the common factor cos a.
    const S moment = (angle.sine + line.distance * angle.cosine) / (angle.cosine - line.distance * angle.sine);
    Vector<S, 6> moved;
    for (int i = 0; i < 3; ++i) {
      S u(0.0), d(0.0);
      for (int k = 0; k < 3; ++k) {
        u = u + line.U(i, k) * turn(k, 0);
        d = d + line.U(i, k) * turn(k, 1);
      }
      moved[i] = moment * u;
      moved[i + 3] = d;
    }
    return moved;
  }

  /// For a line through the origin, where w has no direction, only turns about the origin are told.
  static Matrix<double, 4, gaugeDirections> gaugeGenerators(const Vector<double, 6>& x) {
    Matrix<double, 4, gaugeDirections> G = Matrix<double, 4, gaugeDirections>::Zero();
    const detail::OrthonormalLine<double> line(x);
    const double m = line.distance;
    G.block<3, 3>(0, gaugeRoll) = line.U.transpose();
    G(3, gaugeScale) = m / (1.0 + m * m);
    if (!(m > 0.0)) return G;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector<double, 3> change = cross<double>(Vector<double, 3>::Unit(axis), line.U.col(1));
      G(1, gaugeX + axis) = -change.dot(line.U.col(2)) / m;
      G(3, gaugeX + axis) = change.dot(line.U.col(0)) / (1.0 + m * m);
    }
    return G;
  }

  static std::vector<Field> fields() { return detail::line3dFields(); }
  void read(FieldReader& reader) { setEstimate(detail::readLine3d(reader)); }
  void write(FieldWriter& writer) const { writer.reals({values(), 6}); }
};

}  // namespace quiver
