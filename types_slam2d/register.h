#pragma once

namespace quiver {

class Registry;

/// Makes the types of planar SLAM known: poses, points, lines and segments, under g2o's tags, and the tags of data
/// lines (laser scans and the like), which are kept as they are.
/// Throws GraphError if one of the tags is taken.
void registerSlam2d(Registry& registry);

namespace detail {
// The parts of registerSlam2d, each compiled on its own.
void registerPoses2d(Registry& registry);
void registerPoints2d(Registry& registry);
void registerOffsets2d(Registry& registry);
void registerLines2d(Registry& registry);
}  // namespace detail

}  // namespace quiver
