#pragma once

/// \file
/// Rotations of space.

#include <quiver/geometry/linear.h>
#include <quiver/geometry/rotation_series.h>

namespace quiver {

/// A rotation of space as a unit quaternion (x, y, z, w), stored unaligned. Tangent phi [rad], body frame.
template <class S>
class SO3 {
 public:
  using Scalar = S;
  static constexpr int dimension = 3;

  SO3() : q_{S(0.0), S(0.0), S(0.0), S(1.0)} {}
  /// From a quaternion: bits and sign are kept unless | |q|^2 - 1 | > 1e-14, then it is normalised. The zero
  /// quaternion is no rotation; the caller refuses it.
  SO3(const S& x, const S& y, const S& z, const S& w) : q_{x, y, z, w} {
    using std::abs, std::sqrt;
    const S squared = x * x + y * y + z * z + w * w;
    const S scale = 1.0 / sqrt(squared);
    const auto far = abs(S(squared - 1.0)) > S(1e-14);
    QUIVER_UNROLL for (int i = 0; i < 4; ++i) q_[i] = select(far, S(q_[i] * scale), q_[i]);
  }
  /// From a quaternion known to be of unit length: nothing is checked.
  static SO3 fromUnit(const S& x, const S& y, const S& z, const S& w) {
    SO3 r{Uninitialised{}};
    r.q_[0] = x;
    r.q_[1] = y;
    r.q_[2] = z;
    r.q_[3] = w;
    return r;
  }
  /// From a rotation matrix, accurate for every angle; the quaternion's largest component is positive.
  static SO3 fromMatrix(const Matrix<S, 3, 3>& m) {
    using std::sqrt;
    // Four times the outer product q q^T; the column of its largest diagonal entry is q up to a factor.
    const S xx = 1.0 + m(0, 0) - m(1, 1) - m(2, 2), yy = 1.0 - m(0, 0) + m(1, 1) - m(2, 2);
    const S zz = 1.0 - m(0, 0) - m(1, 1) + m(2, 2), ww = 1.0 + m(0, 0) + m(1, 1) + m(2, 2);
    const S xy = m(1, 0) + m(0, 1), xz = m(2, 0) + m(0, 2), yz = m(2, 1) + m(1, 2);
    const S xw = m(2, 1) - m(1, 2), yw = m(0, 2) - m(2, 0), zw = m(1, 0) - m(0, 1);
    const auto useY = yy > xx;
    const S p = select(useY, yy, xx);
    const auto useW = ww > zz;
    const S r = select(useW, ww, zz);
    const auto useSecond = r > p;
    const S scale = 0.5 / sqrt(select(useSecond, r, p));
    const auto pick = [&](const S& x, const S& y, const S& z, const S& w) {
      return S(scale * select(useSecond, select(useW, w, z), select(useY, y, x)));
    };
    return SO3(pick(xx, xy, xz, xw), pick(xy, yy, yz, yw), pick(xz, yz, zz, zw), pick(xw, yw, zw, ww));
  }

  const S& x() const { return q_[0]; }
  const S& y() const { return q_[1]; }
  const S& z() const { return q_[2]; }
  const S& w() const { return q_[3]; }
  /// (x, y, z, w)
  Vector<S, 4> coefficients() const { return Vector<S, 4>(q_[0], q_[1], q_[2], q_[3]); }

  /// The rotation about phi by |phi| radians.
  static SO3 exp(const Vector<S, 3>& phi) {
    const RotationSeries<S> f(dot<S>(phi, phi));
    const S k = f.halfSinc();
    return fromUnit(k * phi[0], k * phi[1], k * phi[2], f.halfCosine());
  }
  /// The rotation vector of length at most pi; insensitive to the quaternion's length. At pi, where two vectors are
  /// right, the sign of the quaternion's vector part decides.
  Vector<S, 3> log() const {
    using std::abs, std::atan2, std::sqrt;
    const S squared = q_[0] * q_[0] + q_[1] * q_[1] + q_[2] * q_[2];
    const S w = abs(q_[3]);
    const auto small = squared < S(1e-6);
    const S safe = select(small, S(1.0), squared);
    const S norm = sqrt(safe);
    const S closed = 2.0 * atan2(norm, w) / norm;
    const S safeW = select(small, w, S(1.0));
    const S u = squared / (safeW * safeW);
    const S near = 2.0 / safeW * (1.0 - u * (1.0 / 3 - u * (1.0 / 5)));  // atan(n/w)/n, remainder u^3/7
    const S k = select(small, near, closed) * signOf(q_[3]);
    return Vector<S, 3>(k * q_[0], k * q_[1], k * q_[2]);
  }

  Matrix<S, 3, 3> matrix() const {
    const S x2 = 2.0 * q_[0], y2 = 2.0 * q_[1], z2 = 2.0 * q_[2];
    const S xx = q_[0] * x2, yy = q_[1] * y2, zz = q_[2] * z2;
    const S xy = q_[0] * y2, xz = q_[0] * z2, yz = q_[1] * z2;
    const S xw = q_[3] * x2, yw = q_[3] * y2, zw = q_[3] * z2;
    Matrix<S, 3, 3> m;
    m(0, 0) = 1.0 - (yy + zz);
    m(0, 1) = xy - zw;
    m(0, 2) = xz + yw;
    m(1, 0) = xy + zw;
    m(1, 1) = 1.0 - (xx + zz);
    m(1, 2) = yz - xw;
    m(2, 0) = xz - yw;
    m(2, 1) = yz + xw;
    m(2, 2) = 1.0 - (xx + yy);
    return m;
  }

  SO3 inverse() const { return fromUnit(-q_[0], -q_[1], -q_[2], q_[3]); }
  friend SO3 operator*(const SO3& a, const SO3& b) {
    const S *p = a.q_, *q = b.q_;
    return fromUnit(
        p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1], p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
        p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3], p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2]);
  }
  friend Vector<S, 3> operator*(const SO3& r, const Vector<S, 3>& p) { return r.rotate(p, r.q_[3]); }
  /// R^T p, without forming the inverse.
  Vector<S, 3> actInverse(const Vector<S, 3>& p) const { return rotate(p, -q_[3]); }
  /// inverse() * b.
  SO3 between(const SO3& b) const { return inverse() * b; }
  /// R Exp(phi), kept at unit length (one Newton step: exact while the length is within 1e-8 of 1).
  SO3 retract(const Vector<S, 3>& phi) const { return (*this * exp(phi)).renormalised(); }
  Vector<S, 3> localCoordinates(const SO3& b) const { return between(b).log(); }
  SO3 renormalised() const {
    const S k = 1.5 - 0.5 * (q_[0] * q_[0] + q_[1] * q_[1] + q_[2] * q_[2] + q_[3] * q_[3]);
    return fromUnit(k * q_[0], k * q_[1], k * q_[2], k * q_[3]);
  }
  /// Ad = R.
  Matrix<S, 3, 3> adjoint() const { return matrix(); }

  /// J_l with Exp(phi + d) = Exp(J_l d) Exp(phi) to first order: I + a phi^ + b phi^ phi^.
  static Matrix<S, 3, 3> leftJacobian(const Vector<S, 3>& phi) {
    const S t = dot<S>(phi, phi);
    const RotationSeries<S> f(t);
    const S b = f.b();
    return combine(1.0 - b * t, f.a(), b, phi);
  }
  /// J_r with Exp(phi + d) = Exp(phi) Exp(J_r d) to first order; equals J_l(-phi).
  static Matrix<S, 3, 3> rightJacobian(const Vector<S, 3>& phi) { return leftJacobian(-phi); }
  /// J_l^-1 = I - phi^/2 + c phi^ phi^, |phi| < 2 pi.
  static Matrix<S, 3, 3> leftJacobianInverse(const Vector<S, 3>& phi) {
    const S t = dot<S>(phi, phi);
    const S c = RotationSeries<S>(t).c();
    return combine(1.0 - c * t, S(-0.5), c, phi);
  }
  static Matrix<S, 3, 3> rightJacobianInverse(const Vector<S, 3>& phi) { return leftJacobianInverse(-phi); }

  /// diagonal I + skew hat(phi) + outer phi phi^T: every function of hat(phi) has this form.
  static Matrix<S, 3, 3> combine(const S& diagonal, const S& skew, const S& outer, const Vector<S, 3>& phi) {
    const S x = outer * phi[0], y = outer * phi[1], z = outer * phi[2];
    const S u = skew * phi[0], v = skew * phi[1], w = skew * phi[2];
    Matrix<S, 3, 3> m;
    m(0, 0) = diagonal + x * phi[0];
    m(1, 1) = diagonal + y * phi[1];
    m(2, 2) = diagonal + z * phi[2];
    m(0, 1) = x * phi[1] - w;
    m(1, 0) = x * phi[1] + w;
    m(0, 2) = x * phi[2] + v;
    m(2, 0) = x * phi[2] - v;
    m(1, 2) = y * phi[2] - u;
    m(2, 1) = y * phi[2] + u;
    return m;
  }

 private:
  struct Uninitialised {};
  explicit SO3(Uninitialised) {}

  /// p + 2 u x (u x p + w p) for the quaternion (u, w).
  Vector<S, 3> rotate(const Vector<S, 3>& p, const S& w) const {
    const S* u = q_;
    const S a = 2.0 * (u[1] * p[2] - u[2] * p[1]);
    const S b = 2.0 * (u[2] * p[0] - u[0] * p[2]);
    const S c = 2.0 * (u[0] * p[1] - u[1] * p[0]);
    return Vector<S, 3>(p[0] + w * a + (u[1] * c - u[2] * b), p[1] + w * b + (u[2] * a - u[0] * c),
                        p[2] + w * c + (u[0] * b - u[1] * a));
  }

  S q_[4];
};

}  // namespace quiver
