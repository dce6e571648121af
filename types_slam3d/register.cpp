#include <quiver/types_slam3d/register.h>

#include <quiver/core/registry/registry.h>

namespace quiver {

void registerSlam3d(Registry& registry) {
  detail::registerPoses3d(registry);
  detail::registerLogarithmicEdges(registry);
  detail::registerPoints3d(registry);
  detail::registerOffsets3d(registry);
  detail::registerCameras3d(registry);
  detail::registerEuler3d(registry);
  detail::registerPlanes3d(registry);
}

}  // namespace quiver
