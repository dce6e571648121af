#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace quiver::bench {

/// A known point and its pixel.
struct KnownPoint {
  Eigen::Vector3d point;
  Eigen::Vector2d pixel;
};

/// The pose of one camera from known points, as object-oriented frameworks do it: vertex and edges on the heap behind
/// virtual calls, each edge with its own error, Jacobian, information and kernel; Levenberg–Marquardt, Huber. Builds
/// everything, makes `iterations` trial steps, and throws it away again.
struct HeapMotion {
  /// Camera to world.
  Eigen::Isometry3d pose;
  double cost = 0.0;
};
HeapMotion moveCameraOnHeap(const Eigen::Isometry3d& start, const std::vector<KnownPoint>& points,
                            const Eigen::Vector4d& intrinsics, double huber, int iterations);

}  // namespace quiver::bench
