#pragma once

#include <quiver/geometry/se3.h>

namespace quiver::detail {

/// g2o's residual of a pose D: translation, then the vector part of its quaternion with the sign that makes its scalar
/// part positive. About half the angle in radians.
template <typename S>
inline Vector<S, 6> quaternionError(const SE3<S>& D) {
  const SO3<S>& q = D.rotation();
  const Vector<S, 3> t = D.translation();
  const S sign = signOf(q.w());
  Vector<S, 6> e;
  e[0] = t[0], e[1] = t[1], e[2] = t[2];
  e[3] = sign * q.x(), e[4] = sign * q.y(), e[5] = sign * q.z();
  return e;
}

/// M_k = ½ (w I + k [v]ₓ) for the quaternion (v, w) of D with w ≥ 0: M₊ φ is how D Exp(0, φ) changes the vector part,
/// M₋ φ how Exp(0, φ) D does. `scale` multiplies it.
template <typename S>
inline Matrix<S, 3, 3> quaternionStep(const SO3<S>& q, double k, double scale = 1.0) {
  const S half = (0.5 * scale) * signOf(q.w());
  const S w = half * q.w(), x = (k * half) * q.x(), y = (k * half) * q.y(), z = (k * half) * q.z();
  Matrix<S, 3, 3> m;
  m(0, 0) = m(1, 1) = m(2, 2) = w;
  m(0, 1) = -z, m(0, 2) = y;
  m(1, 0) = z, m(1, 2) = -x;
  m(2, 0) = -y, m(2, 1) = x;
  return m;
}

/// Writes the four 3×3 blocks of a Jacobian whose rotation rows do not feel translation.
template <typename S>
inline void setPoseBlocks(const Matrix<S, 3, 3>& byRho, const Matrix<S, 3, 3>& byPhi, const Matrix<S, 3, 3>& turn,
                          Matrix<S, 6, 6>& J) {
  QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
    QUIVER_UNROLL for (int r = 0; r < 3; ++r) {
      J(r, c) = byRho(r, c);
      J(r, c + 3) = byPhi(r, c);
      J(r + 3, c) = S(0.0);
      J(r + 3, c + 3) = turn(r, c);
    }
  }
}

/// a b, written out: without temporaries of Eigen in lanes.
template <typename S>
inline Matrix<S, 3, 3> product3(const Matrix<S, 3, 3>& a, const Matrix<S, 3, 3>& b) {
  Matrix<S, 3, 3> m;
  QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
    QUIVER_UNROLL for (int r = 0; r < 3; ++r) m(r, c) = a(r, 0) * b(0, c) + a(r, 1) * b(1, c) + a(r, 2) * b(2, c);
  }
  return m;
}

/// R [t]ₓ, written out.
template <typename S>
inline Matrix<S, 3, 3> timesHat(const Matrix<S, 3, 3>& R, const Vector<S, 3>& t) {
  Matrix<S, 3, 3> m;
  QUIVER_UNROLL for (int r = 0; r < 3; ++r) {
    m(r, 0) = R(r, 1) * t[2] - R(r, 2) * t[1];
    m(r, 1) = R(r, 2) * t[0] - R(r, 0) * t[2];
    m(r, 2) = R(r, 0) * t[1] - R(r, 1) * t[0];
  }
  return m;
}

template <typename S>
inline Matrix<S, 3, 3> negated(const Matrix<S, 3, 3>& a) {
  Matrix<S, 3, 3> m;
  QUIVER_UNROLL for (int c = 0; c < 3; ++c) { QUIVER_UNROLL for (int r = 0; r < 3; ++r) m(r, c) = -a(r, c); }
  return m;
}

template <typename S>
inline Matrix<S, 3, 3> transposed(const Matrix<S, 3, 3>& a) {
  Matrix<S, 3, 3> m;
  QUIVER_UNROLL for (int c = 0; c < 3; ++c) { QUIVER_UNROLL for (int r = 0; r < 3; ++r) m(r, c) = a(c, r); }
  return m;
}

/// ∂e(D Exp(δ))/∂δ = [R, 0; 0, M₊].
template <typename S>
inline void quaternionErrorByRight(const SE3<S>& D, Matrix<S, 6, 6>& J) {
  Matrix<S, 3, 3> zero;
  QUIVER_UNROLL for (int c = 0; c < 3; ++c) { QUIVER_UNROLL for (int r = 0; r < 3; ++r) zero(r, c) = S(0.0); }
  setPoseBlocks<S>(D.rotation().matrix(), zero, quaternionStep<S>(D.rotation(), 1.0), J);
}

/// ∂e(A Exp(δ) B)/∂δ with D = A B, R the rotation of A, t the translation of B: [R, −R [t]ₓ; 0, M₋ R].
template <typename S>
inline void quaternionErrorByMiddle(const SE3<S>& D, const Matrix<S, 3, 3>& R, const Vector<S, 3>& t,
                                    Matrix<S, 6, 6>& J) {
  setPoseBlocks<S>(R, timesHat<S>(R, Vector<S, 3>(-t[0], -t[1], -t[2])),
                   product3<S>(quaternionStep<S>(D.rotation(), -1.0), R), J);
}

/// ∂e(A Exp(−δ) B)/∂δ, the negative of the above.
template <typename S>
inline void quaternionErrorByInverse(const SE3<S>& D, const Matrix<S, 3, 3>& R, const Vector<S, 3>& t,
                                     Matrix<S, 6, 6>& J) {
  setPoseBlocks<S>(negated<S>(R), timesHat<S>(R, t), product3<S>(quaternionStep<S>(D.rotation(), -1.0, -1.0), R), J);
}

}  // namespace quiver::detail
