#pragma once

/// \file
/// The vectors and matrices of quiver are Eigen's.

#include <quiver/geometry/scalar/scalar.h>
#include <Eigen/Core>

namespace quiver {

using Eigen::Dynamic;
using Eigen::Matrix;
using Eigen::Vector;

/// a x b.
template <class S>
inline Vector<S, 3> cross(const Vector<S, 3>& a, const Vector<S, 3>& b) {
  return Vector<S, 3>(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}

template <class S>
inline S dot(const Vector<S, 3>& a, const Vector<S, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The skew-symmetric matrix with hat(a) b = a x b; its diagonal is literally zero.
template <class S>
inline Matrix<S, 3, 3> hat(const Vector<S, 3>& a) {
  Matrix<S, 3, 3> m;
  m(0, 0) = m(1, 1) = m(2, 2) = S(0.0);
  m(0, 1) = -a[2];
  m(0, 2) = a[1];
  m(1, 0) = a[2];
  m(1, 2) = -a[0];
  m(2, 0) = -a[1];
  m(2, 1) = a[0];
  return m;
}

/// The vector of a skew-symmetric matrix, the inverse of hat(); only the part below the diagonal and (0, 2) are read.
template <class S>
inline Vector<S, 3> vee(const Matrix<S, 3, 3>& m) {
  return Vector<S, 3>(m(2, 1), m(0, 2), m(1, 0));
}

/// The inverse of a 3 x 3 matrix by cofactors, without branches; infinite for a singular one.
template <class S>
inline Matrix<S, 3, 3> inverse3(const Matrix<S, 3, 3>& m) {
  const Vector<S, 3> a(m(0, 0), m(1, 0), m(2, 0)), b(m(0, 1), m(1, 1), m(2, 1)), c(m(0, 2), m(1, 2), m(2, 2));
  const Vector<S, 3> bc = cross<S>(b, c), ca = cross<S>(c, a), ab = cross<S>(a, b);
  const S scale = S(1.0) / dot<S>(a, bc);
  Matrix<S, 3, 3> r;
  QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
    r(0, i) = bc[i] * scale;
    r(1, i) = ca[i] * scale;
    r(2, i) = ab[i] * scale;
  }
  return r;
}

}  // namespace quiver
