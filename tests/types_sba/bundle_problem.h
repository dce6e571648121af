#pragma once

#include <random>

#include <quiver/core/graph/graph.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_sba/models/edge_project.h>

namespace quiver::test {

/// Poses 0 to 3 before a wall of points 100, 101, …, all of which they see through one pinhole camera, parameter 0;
/// estimates off by a little, pixels exact.
class BundleProblem {
 public:
  static constexpr int poses = 4, points = 30;
  static constexpr std::int64_t firstPoint = 100;

  explicit BundleProblem(double error = 0.02) : graph(builtinRegistry()) {
    graph.addParameter<ParameterPinhole>(0, intrinsics());
    std::mt19937_64 random(3);
    const auto noise = [&] { return error * (static_cast<double>(random() >> 11) * 0x1p-52 - 1.0); };
    for (int i = 0; i < poses; ++i) {
      Vector<double, 6> off;
      for (int k = 0; k < 6; ++k) off[k] = noise();
      graph.addVertex<VertexSE3>(i, pose(i).retract(off));
    }
    for (int j = 0; j < points; ++j) {
      const Vector<double, 3> off(noise(), noise(), noise());
      graph.addVertex<VertexXYZ>(firstPoint + j, point(j) + off);
    }
  }

  /// Every pose sees every point.
  BundleProblem& withPixels() {
    for (int i = 0; i < poses; ++i) {
      for (int j = 0; j < points; ++j) {
        graph.addEdge<EdgeProjectPinhole>({i, firstPoint + j}, pixel(i, j), Matrix<double, 2, 2>::Identity(), {0});
      }
    }
    return *this;
  }

  static Vector<double, 4> intrinsics() { return {500.0, 510.0, 320.0, 240.0}; }
  static SE3<double> pose(int i) {
    return SE3<double>(SO3<double>::exp({0.05 * i, -0.1 * i, 0.02 * i}), {0.8 * i, 0.1 * i, -0.2 * i});
  }
  static Vector<double, 3> point(int j) {
    return {0.7 * (j % 6) - 1.0, 0.6 * (j / 6) - 1.2, 5.0 + 0.9 * ((j * 7) % 5)};
  }
  static Vector<double, 2> pixel(int i, int j) {
    return CameraPinhole::project<double>(intrinsics(), pose(i).actInverse(point(j)));
  }

  Graph graph;
};

}  // namespace quiver::test
