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

/// R at row `row` of J and column `column`.
template <typename S, typename Block>
inline void rotation(const SO2<S>& r, Block& J, int row = 0, int column = 0) {
  J(row, column) = J(row + 1, column + 1) = r.cosine();
  J(row, column + 1) = -r.sine();
  J(row + 1, column) = r.sine();
}

}  // namespace quiver::detail
