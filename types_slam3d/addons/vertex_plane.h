#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/se3.h>

namespace quiver {

namespace detail {

/// The frame that a unit vector n carries: n itself, the direction of growing azimuth, and that of growing elevation,
/// R_z(azimuth) R_y(−elevation). At the poles, where the azimuth is open, it is taken as 0.
template <typename S>
inline Matrix<S, 3, 3> normalFrame(const Vector<S, 3>& n) {
  using std::sqrt;
  const S square = n[0] * n[0] + n[1] * n[1];
  const auto pole = square < S(1e-24);
  const S h = sqrt(select(pole, S(1.0), square));
  const S c = select(pole, S(1.0), S(n[0] / h)), s = select(pole, S(0.0), S(n[1] / h));
  const S level = select(pole, S(0.0), h);
  Matrix<S, 3, 3> R;
  R(0, 0) = n[0], R(1, 0) = n[1], R(2, 0) = n[2];
  R(0, 1) = -s, R(1, 1) = c, R(2, 1) = S(0.0);
  R(0, 2) = -n[2] * c, R(1, 2) = -n[2] * s, R(2, 2) = level;
  return R;
}

/// Coefficients with a normal of unit length; bits are kept unless | |n|² − 1 | > 1e-14.
inline Vector<double, 4> normalizedPlane(const Vector<double, 4>& plane) {
  const double square = plane.head<3>().squaredNorm();
  return std::abs(square - 1.0) > 1e-14 ? Vector<double, 4>(plane / std::sqrt(square)) : plane;
}

/// Reads a b c d; refuses a normal of no length.
inline Vector<double, 4> readPlane(FieldReader& reader) {
  Vector<double, 4> plane;
  reader.reals({plane.data(), 4});
  if (!(plane.head<3>().squaredNorm() > 1e-24)) reader.fail("a plane's normal must not be zero");
  return normalizedPlane(plane);
}

inline std::vector<Field> planeFields() {
  return {
      {"a", "", "unit normal"}, {"b", "", ""},     {"c", "", ""},   {"d", "m", "minus the distance along the normal"},
      {"red", "", "colour"},    {"green", "", ""}, {"blue", "", ""}};
}

}  // namespace detail

/// A plane a x + b y + c z + d = 0 with |(a, b, c)| = 1. Tangent: azimuth and elevation of the normal in the frame that
/// it carries [rad], and the distance −d [m].
class VertexPlane : public BaseVertex<VertexPlane, 3, Vector<double, 4>> {
 public:
  static constexpr std::array tangent{"azimuth [rad]", "elevation [rad]", "distance [m]"};

  template <typename S>
  static Vector<S, 4> oplus(const Vector<S, 4>& x, const Vector<S, 3>& delta) {
    using std::sqrt;
    const SinCos<S> azimuth = sincos(delta[0]), elevation = sincos(delta[1]);
    const Matrix<S, 3, 3> R = detail::normalFrame<S>(Vector<S, 3>(x[0], x[1], x[2]));
    const S a = elevation.cosine * azimuth.cosine, b = elevation.cosine * azimuth.sine;
    Vector<S, 3> n;
    for (int i = 0; i < 3; ++i) n[i] = R(i, 0) * a + R(i, 1) * b + R(i, 2) * elevation.sine;
    const S scale = 1.0 / sqrt(dot<S>(n, n));
    return Vector<S, 4>(n[0] * scale, n[1] * scale, n[2] * scale, x[3] - delta[2]);
  }

  static Matrix<double, 3, gaugeDirections> gaugeGenerators(const Vector<double, 4>& x) {
    Matrix<double, 3, gaugeDirections> G = Matrix<double, 3, gaugeDirections>::Zero();
    const Vector<double, 3> n = x.head<3>();
    const Matrix<double, 3, 3> R = detail::normalFrame<double>(n);
    G.block<1, 3>(2, gaugeX) = n.transpose();
    G.block<2, 3>(0, gaugeRoll) = R.rightCols<2>().transpose() * -hat<double>(n);
    G(2, gaugeScale) = -x[3];
    return G;
  }

  std::array<double, 3> colour() const { return colour_; }
  void setColour(const std::array<double, 3>& colour) { colour_ = colour; }

  static std::vector<Field> fields() {
    std::vector<Field> fields = detail::planeFields();
    for (auto field = fields.end() - 3; field != fields.end(); ++field)
      field->documentation = "colour; all three may be left out";
    return fields;
  }
  void read(FieldReader& reader) {
    setEstimate(detail::readPlane(reader));
    if (!reader.atEnd()) reader.reals(colour_);
  }
  void write(FieldWriter& writer) const {
    writer.reals({values(), 4});
    writer.reals(colour_);
  }

 private:
  std::array<double, 3> colour_{0.1, 0.1, 0.1};
};

}  // namespace quiver
