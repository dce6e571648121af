#pragma once

#include <cstdint>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// The robot on a sphere of the SLAM lectures: it climbs from pole to pole in laps, measures each step, and measures
/// poses of the lap below when it passes them.
struct SphereSettings {
  int laps = 50;
  int nodesPerLap = 50;
  /// Metres.
  double radius = 100.0;
  /// Standard deviations of a measurement's translation [m] and rotation [rad], about each body axis.
  Vector<double, 3> translationNoise{0.01, 0.01, 0.01};
  Vector<double, 3> rotationNoise{0.01, 0.01, 0.01};
  std::uint64_t seed = 0;
};

struct SimulatedGraph {
  /// Estimates are the noisy odometry, accumulated from the first true pose, which is fixed.
  Graph measured;
  /// The same graph at the true poses.
  Graph truth;
};

/// The same bits for the same settings everywhere. Poses are VERTEX_SE3:QUAT, measurements EDGE_SE3:QUAT whose
/// information fits the noise. Throws GraphError if laps < 1, nodesPerLap < 3 or a number is not positive and finite.
SimulatedGraph simulateSphere(const SphereSettings& settings, std::shared_ptr<const Registry> registry);

}  // namespace quiver::app
