#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3_offset.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerOffsets3d(Registry& registry) {
  registry.addEdge<EdgeSE3Offset>("EDGE_SE3_OFFSET",
                                  "Pose of one sensor seen from another. Error: translation and vector part of the "
                                  "quaternion of Z^-1 (X1 P1)^-1 (X2 P2); information in this order.");
  registry.addEdge<EdgeSE3Calibration>("EDGE_SE3_CALIB",
                                       "Motion of a sensor whose pose C in the body is the third vertex. Error: "
                                       "translation and vector part of the quaternion of Z^-1 (X1 C)^-1 (X2 C); "
                                       "information in this order.");
}

}  // namespace quiver::detail
