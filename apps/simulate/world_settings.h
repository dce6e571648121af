#pragma once

#include <cstdint>
#include <string>

namespace quiver::app {

/// A robot in a flat world, as g2o's simulators have it, and what it senses.
enum class WorldKind {
  /// A random walk on the streets of a city: 70 % straight on, 15 % to either side, back at the border.
  manhattan,
  /// Up and down the lines of a grid.
  grid,
  /// manhattan among points of the plane.
  landmarks2d,
  /// manhattan among points in space, with poses in space.
  landmarks3d,
};

struct WorldSettings {
  WorldKind kind = WorldKind::manhattan;
  std::int64_t poses = 3500;
  /// Side of the world in metres; 0: such that a place is visited three times on average.
  std::int64_t side = 0;
  std::int64_t landmarks = 1000;
  std::uint64_t seed = 0;
  bool odometry = true;
  /// Poses of earlier visits nearby, as loop closures.
  bool poseSensor = true;
  /// Where a landmark is, in the robot's frame (in space: in the camera's).
  bool pointSensor = false;
  /// In the plane: its direction. In space: its pixel and depth, its pixel and disparity.
  bool bearingSensor = false;
  bool depthSensor = false;
  bool disparitySensor = false;
  /// The heading (in space: the orientation) in the world.
  bool compass = false;
  /// The place in the world.
  bool gps = false;
};

struct WorldCounts {
  std::int64_t poses = 0;
  std::int64_t landmarks = 0;
  std::int64_t edges = 0;
};

/// Writes the graph to `output` as .g2o, with noisy odometry as its estimates and landmarks where they were first seen,
/// and, unless `truth` is empty, the same measurements at the true estimates. Element by element, so memory holds the
/// true places (16 bytes a pose) and the landmarks, not the graph. The same bytes for the same settings everywhere.
/// Throws GraphError if settings make no sense, FileError if a file cannot be written.
WorldCounts simulateWorld(const WorldSettings& settings, const std::string& output, const std::string& truth);

}  // namespace quiver::app
