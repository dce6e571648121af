#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/vertex_cam.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

namespace detail {

/// What P2MC and P2SC share: e = view(X⁻¹ l) − z.
template <typename Edge, int Rows>
class CamProjection : public BaseEdge<Edge, Rows, Vector<double, Rows>, VertexXYZ, VertexCam> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, Rows> computeError(const Vector<S, Rows>& z, const Vector<S, 3>& point,
                                      const PosedCamera<S>& camera) {
    return difference<S, Rows>(camera.stereo().template project<Rows>(camera.pose.actInverse(point)), z);
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, Rows>&, const Vector<S, 3>& point, const PosedCamera<S>& camera,
                             Matrix<S, Rows, 3>& J0, Matrix<S, Rows, 6>& J1) {
    const Vector<S, 3> p = camera.pose.actInverse(point);
    projectionJacobians<S, Rows>(camera.stereo().template pointJacobian<Rows>(p, 1.0), camera.pose, p, J1, J0);
  }
  static bool isDepthPositive(const Vector<double, Rows>&, const Vector<double, 3>& point,
                              const PosedCamera<double>& camera) {
    return camera.pose.actInverse(point)[2] > 0.0;
  }
  /// A stereo pair tells the point.
  static bool initialEstimate(int to, const Vector<double, Rows>& z, Vector<double, 3>& point,
                              PosedCamera<double>& camera) {
    if constexpr (Rows == 3) {
      if (to != 0 || !triangulate(camera.stereo(), z, point)) return false;
      point = camera.pose * point;
      return true;
    }
    return false;
  }
  static std::vector<Field> fields() { return pixelFields<Rows>(); }
};

}  // namespace detail

/// A pixel of a point in a camera: e = π(X⁻¹ l) − z (g2o's EDGE_PROJECT_P2MC).
class EdgeProjectP2MC : public detail::CamProjection<EdgeProjectP2MC, 2> {};

/// A pixel of a point in a stereo camera and its column in the right image (g2o's EDGE_PROJECT_P2SC).
class EdgeProjectP2SC : public detail::CamProjection<EdgeProjectP2SC, 3> {};

/// A pixel of a point in a camera whose intrinsics are a vertex: e = π(X⁻¹ l) − z; the camera's own are not used (g2o's
/// EDGE_PROJECT_P2MC_INTRINSICS).
class EdgeProjectP2MCIntrinsics
    : public BaseEdge<EdgeProjectP2MCIntrinsics, 2, Vector<double, 2>, VertexXYZ, VertexCam, VertexIntrinsics> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 3>& point, const PosedCamera<S>& camera,
                                   const Vector<S, 5>& k) {
    return detail::difference<S, 2>(of(k).template project<2>(camera.pose.actInverse(point)), z);
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 3>& point, const PosedCamera<S>& camera,
                             const Vector<S, 5>& k, Matrix<S, 2, 3>& J0, Matrix<S, 2, 6>& J1, Matrix<S, 2, 4>& J2) {
    const Vector<S, 3> p = camera.pose.actInverse(point);
    detail::projectionJacobians<S, 2>(of(k).template pointJacobian<2>(p, 1.0), camera.pose, p, J1, J0);
    const S w = 1.0 / p[2];
    J2(0, 0) = p[0] * w, J2(1, 1) = p[1] * w;
    J2(0, 2) = J2(1, 3) = S(1.0);
    J2(0, 1) = J2(0, 3) = J2(1, 0) = J2(1, 2) = S(0.0);
  }
  static bool isDepthPositive(const Vector<double, 2>&, const Vector<double, 3>& point,
                              const PosedCamera<double>& camera, const Vector<double, 5>&) {
    return camera.pose.actInverse(point)[2] > 0.0;
  }
  static std::vector<Field> fields() { return detail::pixelFields<2>(); }

 private:
  template <typename S>
  static detail::StereoCamera<S> of(const Vector<S, 5>& k) {
    return {k[0], k[1], k[2], k[3], S(0.0)};
  }
};

}  // namespace quiver
