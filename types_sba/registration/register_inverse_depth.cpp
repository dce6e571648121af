#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/edge_project_inverse_depth.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerInverseDepth(Registry& registry) {
  registry.addVertex<VertexInverseDepth>("VERTEX_INVERSE_DEPTH",
                                         "Point (x/z, y/z, 1/z) in the frame of the pose it is anchored in. Step: "
                                         "addition.");
  registry.addEdge<EdgeProjectPSI2UV>("EDGE_PROJECT_PSI2UV:EXPMAP",
                                      "Pixel of a point anchored in the third vertex: the VERTEX_TRACKXYZ holds "
                                      "(x/z, y/z, 1/z) there. Error z - pi(X^-1 A y); information (u, v).");
  registry.addAlias("EDGE_PROJECT_PSI2UV", "EDGE_PROJECT_PSI2UV:EXPMAP");
  registry.addEdge<EdgeProjectInverseDepth>(
      "EDGE_PROJECT_INVERSE_DEPTH",
      "Pixel of a point anchored in the third vertex, seen from the second. Error "
      "z - pi(X^-1 A y); information (u, v).");
  registry.addEdge<EdgeProjectInverseDepthAnchor>("EDGE_PROJECT_INVERSE_DEPTH:ANCHOR",
                                                  "Pixel of a point in the pose it is anchored in. Error "
                                                  "z - (f x/z + cx, f y/z + cy); information (u, v).");
}

}  // namespace quiver::detail
