#include <quiver/types_sba/register.h>

#include <quiver/core/registry/registry.h>

namespace quiver {

void registerSba(Registry& registry) {
  detail::registerBalCameras(registry);
  detail::registerCams(registry);
  detail::registerExpmap(registry);
  detail::registerExpmapProjections(registry);
  detail::registerInverseDepth(registry);
  detail::registerSimilarities(registry);
  detail::registerCameraModels(registry);
  detail::registerDistortedCameraModels(registry);
}

}  // namespace quiver
