#pragma once

/// \file
/// Rigid motions of space.

#include <quiver/geometry/so3.h>

namespace quiver {

/// A pose in space: rotation and translation [m]. Tangent (rho, phi): metres, radians, translation first, body frame.
///
/// Its Jacobians follow from those of SO(3): SE(3) is SO(3) over numbers phi + epsilon rho with epsilon^2 = 0, so each
/// off-diagonal block is the derivative of the diagonal one along rho. They are exact for every angle below 2 pi;
/// coefficients switch from power series to closed forms at 1 rad with errors below 1e-14 (RotationSeries).
template <class S>
class SE3 {
 public:
  using Scalar = S;
  static constexpr int dimension = 6;

  SE3() : t_{S(0.0), S(0.0), S(0.0)} {}
  SE3(const SO3<S>& rotation, const Vector<S, 3>& translation)
      : r_(rotation), t_{translation[0], translation[1], translation[2]} {}
  /// Translation [m], then the quaternion, whose bits are kept unless it is not of unit length: see SO3.
  SE3(const S& x, const S& y, const S& z, const S& qx, const S& qy, const S& qz, const S& qw)
      : r_(qx, qy, qz, qw), t_{x, y, z} {}

  const SO3<S>& rotation() const { return r_; }
  Vector<S, 3> translation() const { return Vector<S, 3>(t_[0], t_[1], t_[2]); }
  /// (x, y, z, qx, qy, qz, qw)
  Vector<S, 7> toVector() const {
    Vector<S, 7> v;
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) v[i] = t_[i];
    v[3] = r_.x();
    v[4] = r_.y();
    v[5] = r_.z();
    v[6] = r_.w();
    return v;
  }
  Matrix<S, 4, 4> matrix() const {
    Matrix<S, 4, 4> m;
    const Matrix<S, 3, 3> r = r_.matrix();
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
      QUIVER_UNROLL for (int j = 0; j < 3; ++j) m(i, j) = r(i, j);
      m(i, 3) = t_[i];
      m(3, i) = S(0.0);
    }
    m(3, 3) = S(1.0);
    return m;
  }

  SE3 inverse() const {
    const Vector<S, 3> t = r_.actInverse(translation());
    return SE3(r_.inverse(), Vector<S, 3>(-t[0], -t[1], -t[2]));
  }
  friend SE3 operator*(const SE3& a, const SE3& b) { return SE3(a.r_ * b.r_, a * b.translation()); }
  friend Vector<S, 3> operator*(const SE3& a, const Vector<S, 3>& p) {
    const Vector<S, 3> q = a.r_ * p;
    return Vector<S, 3>(q[0] + a.t_[0], q[1] + a.t_[1], q[2] + a.t_[2]);
  }
  /// The point seen from this pose: inverse() * p.
  Vector<S, 3> actInverse(const Vector<S, 3>& p) const {
    return r_.actInverse(Vector<S, 3>(p[0] - t_[0], p[1] - t_[1], p[2] - t_[2]));
  }
  /// inverse() * b with one rotation of a point.
  SE3 between(const SE3& b) const { return SE3(r_.inverse() * b.r_, actInverse(b.translation())); }

  static SE3 exp(const Vector<S, 6>& tangent) {
    const Vector<S, 3> rho = rhoOf(tangent), phi = phiOf(tangent);
    const RotationSeries<S> f(dot<S>(phi, phi));
    const S k = f.halfSinc(), a = f.a(), b = f.b();
    const Vector<S, 3> once = cross<S>(phi, rho), twice = cross<S>(phi, once);
    return SE3(SO3<S>::fromUnit(k * phi[0], k * phi[1], k * phi[2], f.halfCosine()),
               Vector<S, 3>(rho[0] + a * once[0] + b * twice[0], rho[1] + a * once[1] + b * twice[1],
                            rho[2] + a * once[2] + b * twice[2]));
  }
  /// The inverse of exp() with |phi| <= pi.
  Vector<S, 6> log() const {
    const Vector<S, 3> phi = r_.log(), t = translation();
    const S c = RotationSeries<S>(dot<S>(phi, phi)).c();
    const Vector<S, 3> once = cross<S>(phi, t), twice = cross<S>(phi, once);
    Vector<S, 6> v;
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
      v[i] = t[i] - 0.5 * once[i] + c * twice[i];
      v[i + 3] = phi[i];
    }
    return v;
  }
  /// X Exp(delta), the step of quiver's poses; the quaternion is kept at unit length.
  SE3 retract(const Vector<S, 6>& delta) const {
    const SE3 moved = *this * exp(delta);
    return SE3(moved.r_.renormalised(), moved.translation());
  }
  Vector<S, 6> localCoordinates(const SE3& b) const { return between(b).log(); }

  /// Ad = [R t^R; 0 R]: X Exp(d) X^-1 = Exp(Ad d).
  Matrix<S, 6, 6> adjoint() const {
    const Matrix<S, 3, 3> r = r_.matrix();
    Matrix<S, 3, 3> tr;
    QUIVER_UNROLL for (int j = 0; j < 3; ++j) {
      tr(0, j) = t_[1] * r(2, j) - t_[2] * r(1, j);
      tr(1, j) = t_[2] * r(0, j) - t_[0] * r(2, j);
      tr(2, j) = t_[0] * r(1, j) - t_[1] * r(0, j);
    }
    return assemble(r, tr);
  }

  /// J_l with Exp(x + d) = Exp(J_l d) Exp(x) to first order: [J Q; 0 J], J that of SO(3).
  static Matrix<S, 6, 6> leftJacobian(const Vector<S, 6>& tangent) {
    const Vector<S, 3> rho = rhoOf(tangent), phi = phiOf(tangent);
    const S t = dot<S>(phi, phi);
    const RotationSeries<S> f(t);
    const S a = f.a(), b = f.b();
    return assemble(SO3<S>::combine(1.0 - b * t, a, b, phi),
                    derivativeAlong(rho, phi, t, a, b, f.slopeOfA(), f.slopeOfB()));
  }
  /// J_r with Exp(x + d) = Exp(x) Exp(J_r d) to first order; equals J_l(-x).
  static Matrix<S, 6, 6> rightJacobian(const Vector<S, 6>& tangent) { return leftJacobian(negated(tangent)); }
  /// J_l^-1, |phi| < 2 pi.
  static Matrix<S, 6, 6> leftJacobianInverse(const Vector<S, 6>& tangent) {
    const Vector<S, 3> rho = rhoOf(tangent), phi = phiOf(tangent);
    const S t = dot<S>(phi, phi);
    const RotationSeries<S> f(t);
    const S c = f.c();
    return assemble(SO3<S>::combine(1.0 - c * t, S(-0.5), c, phi),
                    derivativeAlong(rho, phi, t, S(-0.5), c, S(0.0), f.slopeOfC()));
  }
  static Matrix<S, 6, 6> rightJacobianInverse(const Vector<S, 6>& tangent) {
    return leftJacobianInverse(negated(tangent));
  }
  /// I + [phi^ rho^; 0 phi^] / 2: J_r^-1 up to terms of second order in the tangent.
  static Matrix<S, 6, 6> rightJacobianInverseApproximation(const Vector<S, 6>& tangent) {
    return assemble(SO3<S>::combine(S(1.0), S(0.5), S(0.0), phiOf(tangent)),
                    SO3<S>::combine(S(0.0), S(0.5), S(0.0), rhoOf(tangent)));
  }

 private:
  static Vector<S, 3> rhoOf(const Vector<S, 6>& v) { return Vector<S, 3>(v[0], v[1], v[2]); }
  static Vector<S, 3> phiOf(const Vector<S, 6>& v) { return Vector<S, 3>(v[3], v[4], v[5]); }
  static Vector<S, 6> negated(const Vector<S, 6>& v) {
    Vector<S, 6> r;
    QUIVER_UNROLL for (int i = 0; i < 6; ++i) r[i] = -v[i];
    return r;
  }
  /// The derivative along rho of I + a(t) phi^ + b(t) (phi phi^T - t I), given a, b and the slopes 2 a', 2 b'.
  static Matrix<S, 3, 3> derivativeAlong(const Vector<S, 3>& rho, const Vector<S, 3>& phi, const S& t, const S& a,
                                         const S& b, const S& slopeA, const S& slopeB) {
    const S d = dot<S>(rho, phi);
    const S skewPhi = d * slopeA, outerPhi = d * slopeB;
    Matrix<S, 3, 3> m = SO3<S>::combine(-(2.0 * b * d + outerPhi * t), skewPhi, outerPhi, phi);
    const S u = a * rho[0], v = a * rho[1], w = a * rho[2];
    const S xy = b * (rho[0] * phi[1] + rho[1] * phi[0]);
    const S xz = b * (rho[0] * phi[2] + rho[2] * phi[0]);
    const S yz = b * (rho[1] * phi[2] + rho[2] * phi[1]);
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) m(i, i) += 2.0 * b * rho[i] * phi[i];
    m(0, 1) += xy - w;
    m(1, 0) += xy + w;
    m(0, 2) += xz + v;
    m(2, 0) += xz - v;
    m(1, 2) += yz - u;
    m(2, 1) += yz + u;
    return m;
  }
  /// [diagonal upper; 0 diagonal]
  static Matrix<S, 6, 6> assemble(const Matrix<S, 3, 3>& diagonal, const Matrix<S, 3, 3>& upper) {
    Matrix<S, 6, 6> m;
    QUIVER_UNROLL for (int j = 0; j < 3; ++j) {
      QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
        m(i, j) = m(i + 3, j + 3) = diagonal(i, j);
        m(i, j + 3) = upper(i, j);
        m(i + 3, j) = S(0.0);
      }
    }
    return m;
  }

  SO3<S> r_;
  S t_[3];
};

}  // namespace quiver
