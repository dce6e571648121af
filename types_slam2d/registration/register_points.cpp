#include <quiver/core/registry/registry.h>
#include <quiver/types_slam2d/edge_se2_bearing.h>
#include <quiver/types_slam2d/edge_se2_points.h>
#include <quiver/types_slam2d/edge_se2_xy.h>
#include <quiver/types_slam2d/edge_xy.h>
#include <quiver/types_slam2d/register.h>

namespace quiver::detail {

void registerPoints2d(Registry& registry) {
  registry.addVertex<VertexXY>("VERTEX_XY", "Point of the plane in the world. Step: addition, in the world's axes.");
  registry.addEdge<EdgeSE2XY>("EDGE_SE2_XY",
                              "Point seen from a pose. Error X^-1 l - z in the body's axes; information (x, y).");
  registry.addEdge<EdgeBearingSE2XY>("EDGE_BEARING_SE2_XY",
                                     "Direction in which a pose sees a point. Error wrap(z - atan2(X^-1 l)); "
                                     "information in 1/rad^2. The initial estimate puts the point at 2 m.");
  registry.addEdge<EdgeXY>("EDGE_POINTXY",
                           "Way from one point to another. Error (l2 - l1) - z in the world's axes; information "
                           "(x, y).");
  registry.addEdge<EdgePriorXY>("EDGE_PRIOR_XY", "Point measured in the world. Error l - z; information (x, y).");
  registry.addEdge<EdgeSE2TwoXY>("EDGE_SE2_TWOPOINTSXY",
                                 "Two points seen from a pose at once. Error X^-1 l1 - z1, X^-1 l2 - z2; information "
                                 "(x1, y1, x2, y2).");
  registry.addEdge<EdgeSE2ManyXY>("EDGE_SE2_LOTSOFXY",
                                  "Any number of points seen from a pose at once; || follows the ids. Error "
                                  "X^-1 li - zi stacked; information in this order.");
}

}  // namespace quiver::detail
