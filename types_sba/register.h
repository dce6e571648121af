#pragma once

namespace quiver {

class Registry;

/// Makes the types of bundle adjustment known: cameras, their intrinsics and what they see, under g2o's tags where g2o
/// has them, and the cameras of the "bundle adjustment in the large" files. Needs the types of registerSlam3d(). Throws
/// GraphError if one of the tags is taken.
void registerSba(Registry& registry);

namespace detail {
// The parts of registerSba, each compiled on its own.
void registerBalCameras(Registry& registry);
void registerCams(Registry& registry);
void registerExpmap(Registry& registry);
void registerExpmapProjections(Registry& registry);
void registerInverseDepth(Registry& registry);
void registerSimilarities(Registry& registry);
void registerCameraModels(Registry& registry);
void registerDistortedCameraModels(Registry& registry);
}  // namespace detail

}  // namespace quiver
