// Cameras on a circle look at points inside it; the focal length, which all of them share, is estimated too. Then one
// new camera is placed by the points alone.
#include <quiver/quiver.h>
#include <quiver/types_sba/models/edge_project.h>
#include <cmath>
#include <iostream>
using namespace quiver;

namespace {

constexpr int cameras = 12;
constexpr std::int64_t firstPoint = 100, points = 60, intrinsics = 1000;
const Vector<double, 4> truth(520.0, 520.0, 320.0, 240.0);  // fx, fy, cx, cy

/// A camera at `angle` on a circle of 8 m, z towards the centre, y down.
SE3<double> poseAt(double angle) {
  Matrix<double, 3, 3> R;
  R.col(2) = Vector<double, 3>(-std::cos(angle), -std::sin(angle), 0.0);
  R.col(1) = Vector<double, 3>(0.0, 0.0, -1.0);
  R.col(0) = cross<double>(R.col(1), R.col(2));
  return SE3<double>(SO3<double>::fromMatrix(R), -8.0 * R.col(2));
}

/// Points on a spiral inside the circle.
Vector<double, 3> pointAt(std::int64_t i) {
  const double t = 0.6 * static_cast<double>(i);
  return {2.0 * std::cos(t), 2.0 * std::sin(t), 0.05 * t - 1.0};
}

Vector<double, 2> pixelOf(const SE3<double>& pose, std::int64_t i) {
  return CameraPinhole::project<double>(truth, pose.actInverse(pointAt(i)));
}

}  // namespace

int main() {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexPinhole>(intrinsics, {500.0, 500.0, 320.0, 240.0}).setFixedDirections(0b1100);  // cx, cy known
  for (std::int64_t i = 0; i < points; ++i)
    graph.addVertex<VertexXYZ>(firstPoint + i, pointAt(i) + Vector<double, 3>(0.05, -0.04, 0.03));
  for (int c = 0; c < cameras; ++c) {
    const SE3<double> pose = poseAt(2.0 * M_PI * c / cameras);
    Vector<double, 6> error;
    error << 0.02, -0.01, 0.03, 0.004, -0.002, 0.003;
    graph.addVertex<VertexSE3>(c, pose.retract(error));
    for (std::int64_t i = 0; i < points; ++i) {
      graph.addEdge<EdgeProjectPinholeIntrinsics>({c, firstPoint + i, intrinsics}, pixelOf(pose, i),
                                                  Matrix<double, 2, 2>::Identity());
    }
  }
  const Summary whole = optimize(graph);
  std::cout << whole << "focal length " << graph.vertex<VertexPinhole>(intrinsics).estimate()[0] << " px\n";

  // One camera more: everything else is held, and only its own observations take part.
  const std::int64_t added = cameras;
  graph.addVertex<VertexSE3>(added, graph.vertex<VertexSE3>(0).estimate());
  for (std::int64_t i = 0; i < points; ++i) {
    graph.addEdge<EdgeProjectPinholeIntrinsics>({added, firstPoint + i, intrinsics}, pixelOf(poseAt(0.2), i),
                                                Matrix<double, 2, 2>::Identity());
  }
  const Summary one = optimize(graph, {.free = {added}});
  std::cout << one;
  const bool found = std::abs(graph.vertex<VertexPinhole>(intrinsics).estimate()[0] - truth[0]) < 1e-3;
  return whole.converged() && one.converged() && found && one.finalChi2 < 1e-6 ? 0 : 1;
}
