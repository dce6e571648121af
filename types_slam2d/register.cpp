#include <quiver/types_slam2d/register.h>

#include <quiver/core/registry/registry.h>

namespace quiver {

void registerSlam2d(Registry& registry) {
  detail::registerPoses2d(registry);
  detail::registerPoints2d(registry);
}

}  // namespace quiver
