#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/vertex_camera_bal.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

/// A pixel of a point in a camera of the "bundle adjustment in the large" files: e = π(R X + t) − z.
class EdgeProjectBal : public BaseEdge<EdgeProjectBal, 2, Vector<double, 2>, VertexCameraBal, VertexXYZ> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const BalCamera<S>& camera, const Vector<S, 3>& point) {
    const Vector<S, 2> pixel = CameraSnavely::project<S>(camera.intrinsics, camera.seen(point));
    return Vector<S, 2>(pixel[0] - z[0], pixel[1] - z[1]);
  }

  /// With N = ∂π/∂p and q = R X: −N [q]ₓ by the rotation, N by the translation, N R by the point.
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const BalCamera<S>& camera, const Vector<S, 3>& point,
                             Matrix<S, 2, 9>& J0, Matrix<S, 2, 3>& J1) {
    const Vector<S, 3> q = camera.turned(point);
    const Vector<S, 3> p(q[0] + camera.translation[0], q[1] + camera.translation[1], q[2] + camera.translation[2]);
    const Matrix<S, 2, 3> N = CameraSnavely::pointJacobian<S>(camera.intrinsics, p);
    const Matrix<S, 2, 3> K = CameraSnavely::intrinsicsJacobian<S>(camera.intrinsics, p);
    const Matrix<S, 3, 3>& R = camera.rotation;
    QUIVER_UNROLL for (int r = 0; r < 2; ++r) {
      J0(r, 0) = N(r, 2) * q[1] - N(r, 1) * q[2];
      J0(r, 1) = N(r, 0) * q[2] - N(r, 2) * q[0];
      J0(r, 2) = N(r, 1) * q[0] - N(r, 0) * q[1];
      QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
        J0(r, 3 + c) = N(r, c);
        J0(r, 6 + c) = K(r, c);
        J1(r, c) = N(r, 0) * R(0, c) + N(r, 1) * R(1, c) + N(r, 2) * R(2, c);
      }
    }
  }

  /// Whether the point is in front of the camera, which looks along −z.
  static bool isDepthPositive(const Vector<double, 2>&, const BalCamera<double>& camera,
                              const Vector<double, 3>& point) {
    return CameraSnavely::isDepthPositive<double>(camera.seen(point));
  }

  static std::vector<Field> fields() { return {{"u", "px", ""}, {"v", "px", ""}}; }
};

}  // namespace quiver
