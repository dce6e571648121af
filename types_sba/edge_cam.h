#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/vertex_cam.h>
#include <quiver/types_slam3d/edge_se3.h>

namespace quiver {

/// The pose of one camera seen from another: EdgeSE3 between cameras (g2o's EDGE_CAM).
class EdgeCam : public BaseEdge<EdgeCam, 6, SE3<double>, VertexCam, VertexCam> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const PosedCamera<S>& from, const PosedCamera<S>& to) {
    return EdgeSE3::computeError<S>(z, from.pose, to.pose);
  }
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const PosedCamera<S>& from, const PosedCamera<S>& to, Matrix<S, 6, 6>& J0,
                             Matrix<S, 6, 6>& J1) {
    EdgeSE3::linearizeOplus<S>(z, from.pose, to.pose, J0, J1);
  }
  /// The intrinsics of the camera that is guessed stay as they are.
  static bool initialEstimate(int to, const SE3<double>& z, PosedCamera<double>& first, PosedCamera<double>& second) {
    return EdgeSE3::initialEstimate(to, z, first.pose, second.pose);
  }
};

/// The distance of two cameras: e = d − |t₂ − t₁| (g2o's EDGE_SCALE). At distance 0 the Jacobian is taken as 0.
class EdgeScale : public BaseEdge<EdgeScale, 1, double, VertexCam, VertexCam> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 1> computeError(const S& d, const PosedCamera<S>& from, const PosedCamera<S>& to) {
    using std::sqrt;
    const Vector<S, 3> way = between(from, to);
    Vector<S, 1> e;
    e[0] = d - sqrt(dot<S>(way, way));
    return e;
  }
  /// With n the direction of t₂ − t₁: nᵀ R₁ by the first translation, −nᵀ R₂ by the second.
  template <typename S>
  static void linearizeOplus(const S&, const PosedCamera<S>& from, const PosedCamera<S>& to, Matrix<S, 1, 6>& J0,
                             Matrix<S, 1, 6>& J1) {
    using std::sqrt;
    const Vector<S, 3> way = between(from, to);
    const S square = dot<S>(way, way);
    const auto apart = square > S(0.0);
    const S scale = select(apart, S(1.0 / sqrt(select(apart, square, S(1.0)))), S(0.0));
    const Vector<S, 3> n(scale * way[0], scale * way[1], scale * way[2]);
    const Vector<S, 3> first = from.pose.rotation().actInverse(n), second = to.pose.rotation().actInverse(n);
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
      J0(0, i) = first[i];
      J1(0, i) = -second[i];
      J0(0, i + 3) = J1(0, i + 3) = S(0.0);
    }
  }
  static std::vector<Field> fields() { return {{"distance", "m", ""}}; }

 private:
  template <typename S>
  static Vector<S, 3> between(const PosedCamera<S>& from, const PosedCamera<S>& to) {
    return detail::difference<S, 3>(to.pose.translation(), from.pose.translation());
  }
};

}  // namespace quiver
