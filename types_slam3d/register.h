#pragma once

namespace quiver {

class Registry;

/// Makes the types of SLAM in space known: poses, points, sensors, planes and lines, under g2o's tags, and the
/// logarithmic pose-graph edge. Throws GraphError if one of the tags is taken.
void registerSlam3d(Registry& registry);

namespace detail {
// The parts of registerSlam3d, each compiled on its own.
void registerPoses3d(Registry& registry);
void registerLogarithmicEdges(Registry& registry);
void registerPoints3d(Registry& registry);
void registerOffsets3d(Registry& registry);
void registerCameras3d(Registry& registry);
void registerEuler3d(Registry& registry);
void registerPlanes3d(Registry& registry);
}  // namespace detail

}  // namespace quiver
