#pragma once

#include <memory>

#include <quiver/quiver.h>

namespace quiver::bench {

/// A robot in the streets of a square city of about poses / 2 crossings: EDGE_SE2 between steps of a metre and to the
/// last pose at the same place. Estimates are noisy odometry. Fixed seed.
Graph manhattanWorld(int poses, std::shared_ptr<const Registry> registry);

/// A robot climbs a sphere in √poses laps of √poses steps: EDGE_SE3:QUAT between steps and to the lap below. Estimates
/// are noisy odometry. Fixed seed.
Graph sphereWorld(int poses, std::shared_ptr<const Registry> registry);

}  // namespace quiver::bench
