#include <quiver/core/registry/registry.h>
#include <quiver/types_slam2d/addons/edge_line2d.h>
#include <quiver/types_slam2d/addons/edge_segment2d.h>
#include <quiver/types_slam2d/register.h>

namespace quiver::detail {

void registerLines2d(Registry& registry) {
  registry.addVertex<VertexSegment2D>("VERTEX_SEGMENT2D", "Segment of the plane by its end points. Step: addition.");
  registry.addVertex<VertexLine2D>("VERTEX_LINE2D",
                                   "Line n(theta).p = rho of the plane; its end points' vertex ids are for drawing. "
                                   "Step: addition, theta wrapped.");
  registry.addEdge<EdgeSE2Segment2D>("EDGE_SE2_SEGMENT2D",
                                     "Segment seen from a pose. Error X^-1 P1 - z1, X^-1 P2 - z2; information "
                                     "(x1, y1, x2, y2).");
  registry.addEdge<EdgeSE2Segment2DLine>("EDGE_SE2_SEGMENT2D_LINE",
                                         "Line through a segment seen from a pose, its normal to the right of P1 to "
                                         "P2. Error (angle - theta, wrapped; distance - rho); information in this "
                                         "order.");
  registry.addEdge<EdgeSE2Segment2DPointLine>("EDGE_SE2_SEGMENT2D_POINTLINE",
                                              "One end of a segment and the direction of its normal seen from a pose. "
                                              "Error (Pk - (x, y), angle - theta wrapped); information in this order.");
  registry.addEdge<EdgeSE2Line2D>("EDGE_SE2_LINE2D",
                                  "Line seen from a pose. Error (theta, rho) of the line in the body less the "
                                  "measured, theta wrapped; information in this order.");
  registry.addEdge<EdgeLine2D>("EDGE_LINE2D",
                               "Difference of two lines' coordinates. Error (l2 - l1) - z, theta wrapped (g2o does "
                               "not wrap it); information (theta, rho).");
  registry.addEdge<EdgeLine2DXY>("EDGE_LINE2D_POINTXY",
                                 "Point at a signed distance d from a line. Error n(theta).p - rho - d.");
}

}  // namespace quiver::detail
