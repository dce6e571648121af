#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3_xyz.h>
#include <quiver/types_slam3d/edge_xyz.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerPoints3d(Registry& registry) {
  registry.addVertex<VertexXYZ>("VERTEX_TRACKXYZ", "Point in the world. Step: addition, in the world's axes.");
  registry.addAlias("VERTEX_XYZ", "VERTEX_TRACKXYZ");
  registry.addEdge<EdgeSE3XYZ>("EDGE_SE3_TRACKXYZ",
                               "Point seen by a sensor. Error (X P)^-1 l - z in the sensor's axes; information "
                               "(x, y, z).");
  registry.addEdge<EdgeXYZ>("EDGE_POINTXYZ",
                            "Way from one point to another. Error (l2 - l1) - z in the world's axes; information "
                            "(x, y, z).");
  registry.addEdge<EdgePriorXYZ>("EDGE_POINTXYZ_PRIOR",
                                 "Point measured in the world. Error l - z; information (x, y, z).");
  registry.addEdge<EdgeSE3ManyXYZ>("EDGE_SE3_LOTSOF_XYZ",
                                   "Any number of points seen from a pose at once; || follows the ids. Error "
                                   "X^-1 li - zi stacked; information in this order.");
}

}  // namespace quiver::detail
