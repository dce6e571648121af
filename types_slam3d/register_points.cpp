#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3_xyz.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerPoints3d(Registry& registry) {
  registry.addVertex<VertexXYZ>("VERTEX_TRACKXYZ", "Point in the world. Step: addition, in the world's axes.");
  registry.addAlias("VERTEX_XYZ", "VERTEX_TRACKXYZ");
  registry.addEdge<EdgeSE3XYZ>("EDGE_SE3_TRACKXYZ",
                               "Point seen by a sensor. Error (X P)^-1 l - z in the sensor's axes; information "
                               "(x, y, z).");
}

}  // namespace quiver::detail
