#pragma once

#include <quiver/evaluation/pose_types.h>

namespace quiver::app {

/// Every vertex type of the registry that is a pose: those whose estimate is an SE2 or SE3, whatever library they come
/// from, and the cameras of types_sba that carry more than a pose.
PoseTypes knownPoses(const Registry& registry);

}  // namespace quiver::app
