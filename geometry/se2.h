#pragma once

/// \file
/// Rigid motions of the plane.

#include <quiver/geometry/rotation_series.h>
#include <quiver/geometry/so2.h>

namespace quiver {

/// A pose in the plane: translation [m] and rotation. Tangent (rho, phi): metres, radians, body frame.
template <class S>
class SE2 {
 public:
  using Scalar = S;
  static constexpr int dimension = 3;

  SE2() : t_{S(0.0), S(0.0)} {}
  /// Translation (x, y) [m] and angle [rad]; the angle is kept as it is.
  SE2(const S& x, const S& y, const S& angle) : t_{x, y}, r_(angle) {}
  SE2(const Vector<S, 2>& translation, const SO2<S>& rotation) : t_{translation[0], translation[1]}, r_(rotation) {}
  /// From (x, y, angle).
  explicit SE2(const Vector<S, 3>& v) : SE2(v[0], v[1], v[2]) {}

  Vector<S, 2> translation() const { return Vector<S, 2>(t_[0], t_[1]); }
  const SO2<S>& rotation() const { return r_; }
  const S& x() const { return t_[0]; }
  const S& y() const { return t_[1]; }
  const S& angle() const { return r_.angle(); }
  /// (x, y, angle)
  Vector<S, 3> toVector() const { return Vector<S, 3>(t_[0], t_[1], r_.angle()); }

  SE2 inverse() const { return SE2(-r_.actInverse(translation()), r_.inverse()); }
  friend SE2 operator*(const SE2& a, const SE2& b) {
    return SE2(a.translation() + a.r_ * b.translation(), a.r_ * b.r_);
  }
  friend Vector<S, 2> operator*(const SE2& a, const Vector<S, 2>& p) { return a.r_ * p + a.translation(); }
  /// The point seen from this pose: inverse() * p.
  Vector<S, 2> actInverse(const Vector<S, 2>& p) const { return r_.actInverse(p - translation()); }
  /// inverse() * b with one rotation.
  SE2 between(const SE2& b) const { return SE2(actInverse(b.translation()), r_.inverse() * b.r_); }

  /// quiver's step for planar poses: t + R rho, wrap(angle + phi). Not the group's exponential: see exp().
  SE2 retract(const Vector<S, 3>& delta) const {
    return SE2(translation() + r_ * Vector<S, 2>(delta[0], delta[1]), SO2<S>(wrapAngle(S(r_.angle() + delta[2]))));
  }
  /// The delta with retract(delta) == b, its angle in (-pi, pi].
  Vector<S, 3> localCoordinates(const SE2& b) const { return between(b).toVector(); }

  /// The exponential of the Lie group SE(2).
  static SE2 exp(const Vector<S, 3>& tangent) {
    const S& phi = tangent[2];
    const RotationSeries<S> f(phi * phi);
    const S along = f.sinc(), across = f.a() * phi;
    return SE2(Vector<S, 2>(along * tangent[0] - across * tangent[1], across * tangent[0] + along * tangent[1]),
               SO2<S>(wrapAngle(phi)));
  }
  /// The inverse of exp(), with the angle in (-pi, pi].
  Vector<S, 3> log() const {
    const S phi = wrapAngle(r_.angle());
    const S squared = phi * phi;
    const S along = 1.0 - RotationSeries<S>(squared).c() * squared;  // (phi/2) cot(phi/2)
    return Vector<S, 3>(along * t_[0] + 0.5 * phi * t_[1], along * t_[1] - 0.5 * phi * t_[0], phi);
  }
  /// Ad: X Exp(d) X^-1 = Exp(Ad d).
  Matrix<S, 3, 3> adjoint() const {
    Matrix<S, 3, 3> m;
    m(0, 0) = m(1, 1) = r_.cosine();
    m(0, 1) = -r_.sine();
    m(1, 0) = r_.sine();
    m(0, 2) = t_[1];
    m(1, 2) = -t_[0];
    m(2, 0) = m(2, 1) = S(0.0);
    m(2, 2) = S(1.0);
    return m;
  }
  /// J_l with Exp(x + d) = Exp(J_l d) Exp(x) to first order.
  static Matrix<S, 3, 3> leftJacobian(const Vector<S, 3>& tangent) { return jacobian(tangent, 1.0); }
  /// J_r with Exp(x + d) = Exp(x) Exp(J_r d) to first order.
  static Matrix<S, 3, 3> rightJacobian(const Vector<S, 3>& tangent) { return jacobian(tangent, -1.0); }

 private:
  static Matrix<S, 3, 3> jacobian(const Vector<S, 3>& tangent, double sign) {
    const S phi = sign * tangent[2], x = sign * tangent[0], y = sign * tangent[1];
    const RotationSeries<S> f(phi * phi);
    const S a = f.a(), b = f.b() * phi;
    Matrix<S, 3, 3> m;
    m(0, 0) = m(1, 1) = f.sinc();
    m(1, 0) = a * phi;
    m(0, 1) = -m(1, 0);
    m(0, 2) = a * y + b * x;
    m(1, 2) = b * y - a * x;
    m(2, 0) = m(2, 1) = S(0.0);
    m(2, 2) = S(1.0);
    return m;
  }

  S t_[2];
  SO2<S> r_;
};

}  // namespace quiver
