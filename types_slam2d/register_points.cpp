#include <quiver/core/registry/registry.h>
#include <quiver/types_slam2d/edge_se2_xy.h>
#include <quiver/types_slam2d/register.h>

namespace quiver::detail {

void registerPoints2d(Registry& registry) {
  registry.addVertex<VertexXY>("VERTEX_XY", "Point of the plane in the world. Step: addition, in the world's axes.");
  registry.addEdge<EdgeSE2XY>("EDGE_SE2_XY",
                              "Point seen from a pose. Error X^-1 l - z in the body's axes; information (x, y).");
}

}  // namespace quiver::detail
