#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/addons/edge_se3_euler.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerEuler3d(Registry& registry) {
  registry.addVertex<VertexSE3Euler>("VERTEX3",
                                     "VERTEX_SE3:QUAT with roll, pitch and yaw in the file, "
                                     "R = Rz(yaw) Ry(pitch) Rx(roll).");
  registry.addEdge<EdgeSE3Euler>(
      "EDGE3",
      "EDGE_SE3:QUAT with roll, pitch and yaw and their information in the file; inside, the "
      "information is mapped to the quaternion's vector part at the measurement, as g2o's.");
}

}  // namespace quiver::detail
