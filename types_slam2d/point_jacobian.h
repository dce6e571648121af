#pragma once

#include <quiver/geometry/se2.h>

namespace quiver::detail {

/// How a point p seen from a pose moves with it: p = X⁻¹ l, ∂p/∂δ = [−I, (p_y, −p_x)ᵀ], written at row `row` of J.
template <typename S, typename Block>
inline void seenPointByPose(const Vector<S, 2>& p, Block& J, int row = 0) {
  J(row, 0) = J(row + 1, 1) = S(-1.0);
  J(row, 1) = J(row + 1, 0) = S(0.0);
  J(row, 2) = p[1];
  J(row + 1, 2) = -p[0];
}

/// Rᵀ at row `row` of J and column `column`.
template <typename S, typename Block>
inline void transposedRotation(const SO2<S>& r, Block& J, int row = 0, int column = 0) {
  J(row, column) = J(row + 1, column + 1) = r.cosine();
  J(row, column + 1) = r.sine();
  J(row + 1, column) = -r.sine();
}

/// How Rᵀ p moves with the pose that sees p = X⁻¹ l: Rᵀ [−I, (p_y, −p_x)ᵀ].
template <typename S>
inline void turnedPointByPose(const SO2<S>& r, const Vector<S, 2>& p, Matrix<S, 2, 3>& J) {
  J(0, 0) = J(1, 1) = -r.cosine();
  J(0, 1) = -r.sine();
  J(1, 0) = r.sine();
  J(0, 2) = r.cosine() * p[1] - r.sine() * p[0];
  J(1, 2) = -(r.sine() * p[1] + r.cosine() * p[0]);
}

}  // namespace quiver::detail
