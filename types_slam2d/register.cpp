#include <quiver/types_slam2d/register.h>

#include <quiver/core/registry/registry.h>

namespace quiver {

void registerSlam2d(Registry& registry) {
  detail::registerPoses2d(registry);
  detail::registerPoints2d(registry);
  detail::registerOffsets2d(registry);
  detail::registerLines2d(registry);
  registry.addDataTag("ROBOTLASER1", "Laser scan in CARMEN's layout, with the poses of laser and odometry.");
  registry.addDataTag("RAWLASER", "Laser scan as it came from the sensor.");
  registry.addDataTag("VERTEX_TAG", "Name, position, odometry and time of a marker.");
  registry.addDataTag("VERTEX_ELLIPSE", "Covariance of a pose and the points it was computed from.");
}

}  // namespace quiver
