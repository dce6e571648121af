#pragma once

#include <algorithm>
#include <cmath>

#include <quiver/geometry/se3.h>

namespace quiver::detail {

/// The rotation R_z(yaw) R_y(pitch) R_x(roll), for angles of any size.
inline SO3<double> fromEuler(double roll, double pitch, double yaw) {
  const auto about = [](int axis, double angle) {
    Vector<double, 3> v = Vector<double, 3>::Zero();
    v[axis] = std::sin(0.5 * angle);
    return SO3<double>(v[0], v[1], v[2], std::cos(0.5 * angle));
  };
  return (about(2, yaw) * about(1, pitch) * about(0, roll)).renormalised();
}

/// (roll, pitch, yaw) of a unit quaternion, pitch in [−π/2, π/2].
template <typename S>
inline Vector<S, 3> toEuler(const S& x, const S& y, const S& z, const S& w) {
  using std::asin, std::atan2;
  const S sine = 2.0 * (w * y - z * x);
  const S bounded = select(sine > S(1.0), S(1.0), select(sine < S(-1.0), S(-1.0), sine));
  return Vector<S, 3>(atan2(S(2.0 * (w * x + y * z)), S(1.0 - 2.0 * (x * x + y * y))), asin(bounded),
                      atan2(S(2.0 * (w * z + x * y)), S(1.0 - 2.0 * (y * y + z * z))));
}

/// Whether (q_x, q_y, q_z) are coordinates around this rotation: they are none of half turns, where yaw changes beyond
/// all bounds with them.
inline bool hasQuaternionChart(const SO3<double>& rotation) {
  constexpr double leastCosine = 1e-6;
  return std::abs(rotation.w()) >= leastCosine;
}

/// Whether Euler angles are coordinates around this rotation: they are none where the pitch is a quarter turn.
inline bool hasEulerChart(const SO3<double>& q) {
  constexpr double margin = 1e-12;
  return std::abs(2.0 * (q.w() * q.y() - q.z() * q.x())) <= 1.0 - margin;
}

/// ∂(roll, pitch, yaw)/∂(q_x, q_y, q_z) with q_w = √(1 − |q_xyz|²): of use only where both
/// are coordinates.
inline Matrix<double, 3, 3> eulerByQuaternion(const SO3<double>& rotation) {
  using D = Dual<double, 3>;
  using std::sqrt;
  const double sign = signOf(rotation.w());
  D q[3];
  const double v[3] = {sign * rotation.x(), sign * rotation.y(), sign * rotation.z()};
  for (int i = 0; i < 3; ++i) {
    q[i] = D(v[i]);
    q[i].gradient[i] = 1.0;
  }
  const Vector<D, 3> euler = toEuler<D>(q[0], q[1], q[2], sqrt(D(1.0 - q[0] * q[0] - q[1] * q[1] - q[2] * q[2])));
  Matrix<double, 3, 3> J;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) J(r, c) = euler[r].gradient[c];
  }
  return J;
}

}  // namespace quiver::detail
