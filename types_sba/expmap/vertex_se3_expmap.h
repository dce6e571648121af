#pragma once

#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// A camera's pose, camera to world (g2o's VERTEX_SE3:EXPMAP, which keeps the inverse in memory and this in files).
/// Tangent: that of VertexSE3.
class VertexSE3Expmap : public BaseVertex<VertexSE3Expmap, 6, SE3<double>> {
 public:
  static constexpr bool lanes = true;
  static constexpr std::array tangent = VertexSE3::tangent;

  template <typename S>
  static SE3<S> oplus(const SE3<S>& x, const Vector<S, 6>& delta) {
    return x.retract(delta);
  }
  static Matrix<double, 6, gaugeDirections> gaugeGenerators(const SE3<double>& x) {
    return VertexSE3::gaugeGenerators(x);
  }
};

}  // namespace quiver
