#pragma once

/// \file
/// Rotations of the plane.

#include <quiver/geometry/linear.h>

namespace quiver {

inline constexpr double pi = 3.14159265358979323846;

/// The angle [rad] plus the multiple of 2 pi that brings it into (-pi, pi]. Angles of magnitude up to the double `pi`
/// come back bit by bit.
template <class S>
inline S wrapAngle(const S& angle) {
  using std::abs, std::fma, std::rint;
  if constexpr (std::is_same_v<S, double>) {
    if (abs(angle) <= pi) return angle;
  }
  constexpr double turnHigh = 6.283185307179586, turnLow = 2.4492935982947064e-16;
  const S turns = rint(S(angle * (1.0 / turnHigh)));
  S wrapped = fma(turns, S(-turnHigh), angle) - turns * turnLow;
  wrapped = select(wrapped > S(pi), S(wrapped - turnHigh), wrapped);
  wrapped = select(wrapped < S(-pi), S(wrapped + turnHigh), wrapped);
  return select(abs(angle) <= S(pi), angle, wrapped);
}

/// A rotation of the plane: its angle as given, and cosine and sine, so that acting and composing need no trigonometry.
template <class S>
class SO2 {
 public:
  using Scalar = S;
  static constexpr int dimension = 1;

  SO2() : angle_(0.0), cosine_(1.0), sine_(0.0) {}
  /// Keeps the angle [rad] as it is, unwrapped.
  explicit SO2(const S& angle) : angle_(angle) {
    const SinCos<S> both = sincos(angle);
    cosine_ = both.cosine;
    sine_ = both.sine;
  }
  /// From parts that belong together: nothing is checked.
  SO2(const S& angle, const S& cosine, const S& sine) : angle_(angle), cosine_(cosine), sine_(sine) {}

  static SO2 exp(const Vector<S, 1>& tangent) { return SO2(wrapAngle(tangent[0])); }
  Vector<S, 1> log() const { return Vector<S, 1>(wrapAngle(angle_)); }

  const S& angle() const { return angle_; }
  const S& cosine() const { return cosine_; }
  const S& sine() const { return sine_; }
  Matrix<S, 2, 2> matrix() const {
    Matrix<S, 2, 2> m;
    m(0, 0) = m(1, 1) = cosine_;
    m(0, 1) = -sine_;
    m(1, 0) = sine_;
    return m;
  }
  SO2 inverse() const { return SO2(-angle_, cosine_, -sine_); }
  Matrix<S, 1, 1> adjoint() const { return Matrix<S, 1, 1>(S(1.0)); }

  /// The composition; its angle is wrapped, cosine and sine are kept on the unit circle.
  friend SO2 operator*(const SO2& a, const SO2& b) {
    const S cosine = a.cosine_ * b.cosine_ - a.sine_ * b.sine_;
    const S sine = a.sine_ * b.cosine_ + a.cosine_ * b.sine_;
    const S scale = 1.5 - 0.5 * (cosine * cosine + sine * sine);
    return SO2(wrapAngle(S(a.angle_ + b.angle_)), cosine * scale, sine * scale);
  }
  friend Vector<S, 2> operator*(const SO2& r, const Vector<S, 2>& p) {
    return Vector<S, 2>(r.cosine_ * p[0] - r.sine_ * p[1], r.sine_ * p[0] + r.cosine_ * p[1]);
  }
  /// R^T p, without forming the inverse.
  Vector<S, 2> actInverse(const Vector<S, 2>& p) const {
    return Vector<S, 2>(cosine_ * p[0] + sine_ * p[1], cosine_ * p[1] - sine_ * p[0]);
  }

 private:
  S angle_, cosine_, sine_;
};

}  // namespace quiver
