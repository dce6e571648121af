#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/addons/edge_line3d.h>
#include <quiver/types_slam3d/addons/edge_plane.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerPlanes3d(Registry& registry) {
  registry.addVertex<VertexPlane>("VERTEX_PLANE",
                                  "Plane a x + b y + c z + d = 0 with unit normal, and a colour. Step: azimuth and "
                                  "elevation in the frame the normal carries, distance -d.");
  registry.addEdge<EdgePlane>("EDGE_PLANE",
                              "Difference of two planes' coefficients. Error (p2 - p1) - z; information (a, b, c, d).");
  registry.addEdge<EdgeSE3Plane>("EDGE_SE3_PLANE_CALIB",
                                 "Plane seen by a sensor whose pose in the body is the third vertex. Error: azimuth "
                                 "and elevation of the measured normal in the frame of the seen one, seen distance "
                                 "less measured; information in this order.");
  registry.addVertex<VertexLine3D>("VERTEX_LINE3D",
                                   "Line by Pluecker's coordinates, moment and unit direction. Step: three turns of "
                                   "the frame (w, d, w x d) about its axes, and the angle whose tangent is |w|.");
  registry.addEdge<EdgeSE3Line3D>("EDGE_SE3_LINE3D",
                                  "Line seen by a sensor. Error: vector part of the quaternion between the frames of "
                                  "the line (X P)^-1 L and the measured one, and the difference of their distance "
                                  "angles; information in this order. (g2o leaves the sensor's pose P out.)");
}

}  // namespace quiver::detail
