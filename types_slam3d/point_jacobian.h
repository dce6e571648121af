#pragma once

#include <quiver/types_slam3d/quaternion_error.h>

namespace quiver::detail {

/// How M p moves with the pose that sees p = X⁻¹ l: ∂/∂δ = M [−I, [p]ₓ].
template <typename S, int Rows>
inline void seenPointByPose(const Matrix<S, Rows, 3>& M, const Vector<S, 3>& p, Matrix<S, Rows, 6>& J) {
  QUIVER_UNROLL for (int r = 0; r < Rows; ++r) {
    QUIVER_UNROLL for (int c = 0; c < 3; ++c) J(r, c) = -M(r, c);
    J(r, 3) = M(r, 1) * p[2] - M(r, 2) * p[1];
    J(r, 4) = M(r, 2) * p[0] - M(r, 0) * p[2];
    J(r, 5) = M(r, 0) * p[1] - M(r, 1) * p[0];
  }
}

}  // namespace quiver::detail
