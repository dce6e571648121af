#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/edge_project_bal.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerBalCameras(Registry& registry) {
  registry.addVertex<VertexCameraBal>(
      "VERTEX_CAMERA:BAL",
      "Camera of the 'bundle adjustment in the large' files: p = R X + t, seen along -z "
      "at f (1 + k1 r^2 + k2 r^4) (-px/pz, -py/pz). Step: Exp(phi) R, the rest added.");
  registry.addEdge<EdgeProjectBal>("EDGE_PROJECT_BAL",
                                   "Pixel of a point in a VERTEX_CAMERA:BAL. Error: seen less measured; information "
                                   "(u, v).");
}

}  // namespace quiver::detail
