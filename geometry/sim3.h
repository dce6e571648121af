#pragma once

/// \file
/// Similarities of space.

#include <quiver/geometry/so3.h>

namespace quiver {

/// A similarity p -> s R p + t. Tangent (rho, phi, sigma): translation, rotation [rad], logarithm of the scale, body
/// frame. Jacobians and the translation's factor are integrals of matrix exponentials, summed as a series of the
/// tangent over 16 and doubled four times: accurate to 1e-13 relative while |phi| <= 2 pi and |sigma| <= 12.
template <class S>
class Sim3 {
 public:
  using Scalar = S;
  static constexpr int dimension = 7;

  Sim3() : t_{S(0.0), S(0.0), S(0.0)}, s_(1.0) {}
  /// The scale must be positive; the caller checks.
  Sim3(const SO3<S>& rotation, const Vector<S, 3>& translation, const S& scale)
      : r_(rotation), t_{translation[0], translation[1], translation[2]}, s_(scale) {}

  const SO3<S>& rotation() const { return r_; }
  Vector<S, 3> translation() const { return Vector<S, 3>(t_[0], t_[1], t_[2]); }
  const S& scale() const { return s_; }
  /// (x, y, z, qx, qy, qz, qw, s)
  Vector<S, 8> toVector() const {
    Vector<S, 8> v;
    v << t_[0], t_[1], t_[2], r_.x(), r_.y(), r_.z(), r_.w(), s_;
    return v;
  }

  Sim3 inverse() const {
    const S inverseScale = 1.0 / s_;
    return Sim3(r_.inverse(), r_.actInverse(translation()) * S(-inverseScale), inverseScale);
  }
  friend Sim3 operator*(const Sim3& a, const Sim3& b) { return Sim3(a.r_ * b.r_, a * b.translation(), a.s_ * b.s_); }
  friend Vector<S, 3> operator*(const Sim3& a, const Vector<S, 3>& p) {
    const Vector<S, 3> q = a.r_ * p;
    return Vector<S, 3>(a.s_ * q[0] + a.t_[0], a.s_ * q[1] + a.t_[1], a.s_ * q[2] + a.t_[2]);
  }
  /// inverse() * p.
  Vector<S, 3> actInverse(const Vector<S, 3>& p) const {
    return r_.actInverse(Vector<S, 3>(p[0] - t_[0], p[1] - t_[1], p[2] - t_[2])) * S(1.0 / s_);
  }
  Sim3 between(const Sim3& b) const { return inverse() * b; }

  static Sim3 exp(const Vector<S, 7>& tangent) {
    using std::exp;
    const Vector<S, 3> rho(tangent[0], tangent[1], tangent[2]), phi(tangent[3], tangent[4], tangent[5]);
    return Sim3(SO3<S>::exp(phi), Vector<S, 3>(translationFactor(phi, tangent[6]) * rho), exp(tangent[6]));
  }
  /// The inverse of exp() with |phi| <= pi.
  Vector<S, 7> log() const {
    using std::log;
    const Vector<S, 3> phi = r_.log();
    const S sigma = log(s_);
    const Vector<S, 3> rho = inverse3<S>(translationFactor(phi, sigma)) * translation();
    Vector<S, 7> v;
    v << rho[0], rho[1], rho[2], phi[0], phi[1], phi[2], sigma;
    return v;
  }
  /// X Exp(delta); the quaternion is kept at unit length.
  Sim3 retract(const Vector<S, 7>& delta) const {
    const Sim3 moved = *this * exp(delta);
    return Sim3(moved.r_.renormalised(), moved.translation(), moved.s_);
  }
  Vector<S, 7> localCoordinates(const Sim3& b) const { return between(b).log(); }

  /// Ad = [sR t^R -t; 0 R 0; 0 0 1]: X Exp(d) X^-1 = Exp(Ad d).
  Matrix<S, 7, 7> adjoint() const {
    const Matrix<S, 3, 3> r = r_.matrix();
    Matrix<S, 7, 7> m = Matrix<S, 7, 7>::Zero();
    m.template block<3, 3>(0, 0) = s_ * r;
    m.template block<3, 3>(0, 3) = hat<S>(translation()) * r;
    m.template block<3, 1>(0, 6) = -translation();
    m.template block<3, 3>(3, 3) = r;
    m(6, 6) = S(1.0);
    return m;
  }
  /// ad with Ad(Exp x) = exp(ad x).
  static Matrix<S, 7, 7> smallAdjoint(const Vector<S, 7>& x) {
    const Vector<S, 3> rho(x[0], x[1], x[2]), phi(x[3], x[4], x[5]);
    Matrix<S, 7, 7> m = Matrix<S, 7, 7>::Zero();
    m.template block<3, 3>(0, 0) = hat<S>(phi);
    for (int i = 0; i < 3; ++i) m(i, i) = x[6];
    m.template block<3, 3>(0, 3) = hat<S>(rho);
    m.template block<3, 1>(0, 6) = -rho;
    m.template block<3, 3>(3, 3) = hat<S>(phi);
    return m;
  }
  /// J_l with Exp(x + d) = Exp(J_l d) Exp(x) to first order.
  static Matrix<S, 7, 7> leftJacobian(const Vector<S, 7>& x) {
    const Matrix<S, 7, 7> A = smallAdjoint(x);
    const AdjointBlocks sum =
        integratedExponential({A.template block<3, 3>(0, 0), A.template block<3, 3>(0, 3), A.template block<3, 3>(3, 3),
                               A.template block<3, 1>(0, 6), S(0.0)});
    Matrix<S, 7, 7> m = Matrix<S, 7, 7>::Zero();
    m.template block<3, 3>(0, 0) = sum.a;
    m.template block<3, 3>(0, 3) = sum.b;
    m.template block<3, 1>(0, 6) = sum.c;
    m.template block<3, 3>(3, 3) = sum.d;
    m(6, 6) = sum.e;
    return m;
  }
  /// J_r with Exp(x + d) = Exp(x) Exp(J_r d) to first order; equals J_l(-x).
  static Matrix<S, 7, 7> rightJacobian(const Vector<S, 7>& x) { return leftJacobian(-x); }
  /// J_l^-1 from J_l = [P Q q; 0 J 0; 0 0 1].
  static Matrix<S, 7, 7> leftJacobianInverse(const Vector<S, 7>& x) {
    const Matrix<S, 7, 7> m = leftJacobian(x);
    const Matrix<S, 3, 3> p = inverse3<S>(m.template block<3, 3>(0, 0));
    const Matrix<S, 3, 3> j = SO3<S>::leftJacobianInverse(Vector<S, 3>(x[3], x[4], x[5]));
    Matrix<S, 7, 7> r = Matrix<S, 7, 7>::Zero();
    r.template block<3, 3>(0, 0) = p;
    r.template block<3, 3>(0, 3) = -(p * Matrix<S, 3, 3>(m.template block<3, 3>(0, 3) * j));
    r.template block<3, 1>(0, 6) = -(p * m.template block<3, 1>(0, 6));
    r.template block<3, 3>(3, 3) = j;
    r(6, 6) = S(1.0);
    return r;
  }
  static Matrix<S, 7, 7> rightJacobianInverse(const Vector<S, 7>& x) { return leftJacobianInverse(-x); }

 private:
  /// Terms of the series and times its argument is halved first.
  static constexpr int terms = 16, doublings = 4;
  /// identity I + skew phi^ + square phi^ phi^, closed under products as phi^ phi^ phi^ = -t phi^ with t = |phi|^2.
  struct Polynomial {
    S identity, skew, square;
    Polynomial times(const Polynomial& o, const S& t) const {
      return {identity * o.identity, identity * o.skew + skew * o.identity - t * (skew * o.square + square * o.skew),
              identity * o.square + square * o.identity + skew * o.skew - t * (square * o.square)};
    }
  };
  /// W with t = W rho: the integral of exp(u (sigma I + phi^)) over u in [0, 1].
  static Matrix<S, 3, 3> translationFactor(const Vector<S, 3>& phi, const S& sigma) {
    const S t = dot<S>(phi, phi);
    const S fraction(1.0 / (1 << doublings));
    Polynomial x{sigma * fraction, fraction, S(0.0)};
    Polynomial sum{S(1.0), S(0.0), S(0.0)};
    for (int k = terms; k >= 1; --k) {
      const S scale(1.0 / (k + 1));
      const Polynomial product = x.times(sum, t);
      sum = {1.0 + scale * product.identity, scale * product.skew, scale * product.square};
    }
    for (int k = 0; k < doublings; ++k) {
      const Polynomial product = x.times(sum, t).times(sum, t);
      sum = {sum.identity + 0.5 * product.identity, sum.skew + 0.5 * product.skew, sum.square + 0.5 * product.square};
      x = {2.0 * x.identity, 2.0 * x.skew, S(0.0)};
    }
    return SO3<S>::combine(S(sum.identity - t * sum.square), sum.skew, sum.square, phi);
  }
  /// [a b c; 0 d 0; 0 0 e]: the form of adjoints, closed under products.
  struct AdjointBlocks {
    Matrix<S, 3, 3> a, b, d;
    Vector<S, 3> c;
    S e;
    AdjointBlocks times(const AdjointBlocks& o) const {
      return {a * o.a, a * o.b + b * o.d, d * o.d, a * o.c + c * o.e, e * o.e};
    }
    AdjointBlocks scaled(const S& f) const { return {a * f, b * f, d * f, c * f, e * f}; }
    AdjointBlocks plus(const AdjointBlocks& o) const { return {a + o.a, b + o.b, d + o.d, c + o.c, e + o.e}; }
    static AdjointBlocks identity() {
      return {Matrix<S, 3, 3>::Identity(), Matrix<S, 3, 3>::Zero(), Matrix<S, 3, 3>::Identity(), Vector<S, 3>::Zero(),
              S(1.0)};
    }
  };
  /// The sum of A^k / (k+1)!, the integral of exp(u A) over [0, 1].
  static AdjointBlocks integratedExponential(const AdjointBlocks& A) {
    AdjointBlocks x = A.scaled(S(1.0 / (1 << doublings)));
    AdjointBlocks sum = AdjointBlocks::identity();
    for (int k = terms; k >= 1; --k) sum = AdjointBlocks::identity().plus(x.times(sum).scaled(S(1.0 / (k + 1))));
    for (int k = 0; k < doublings; ++k) {
      // F(2X) = (I + exp X) F(X) / 2 with exp X = I + X F(X).
      sum = sum.plus(x.times(sum).times(sum).scaled(S(0.5)));
      x = x.scaled(S(2.0));
    }
    return sum;
  }

  SO3<S> r_;
  S t_[3];
  S s_;
};

}  // namespace quiver
