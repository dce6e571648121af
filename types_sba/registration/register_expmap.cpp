#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/expmap/edge_project_xyz2uv.h>
#include <quiver/types_sba/expmap/edge_se3_expmap.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerExpmap(Registry& registry) {
  registry.addVertex<VertexSE3Expmap>(
      "VERTEX_SE3:EXPMAP",
      "Camera in the world, z forward; as VERTEX_SE3:QUAT in memory, too (g2o turns the "
      "pose round). Step: X Exp(rho, phi), translation first.");
  registry.addParameter<ParameterCameraParameters>("PARAMS_CAMERAPARAMETERS",
                                                   "Focal length, principal point and stereo baseline.");
  registry.addEdge<EdgeSE3Expmap>("EDGE_SE3:EXPMAP",
                                  "Pose Z of the second camera seen from the first. Error ln(X2 Z^-1 X1^-1), rotation "
                                  "first, translation second, in the world's axes; information in this order.");
  registry.addEdge<EdgeProjectXYZ2UV>("EDGE_PROJECT_XYZ2UV:EXPMAP",
                                      "Pixel of a point. Error z - (f x/z + cx, f y/z + cy); information (u, v).");
  registry.addEdge<EdgeProjectXYZ2UVU>("EDGE_PROJECT_XYZ2UVU:EXPMAP",
                                       "Pixel of a point in a stereo camera. Error z - (f x/z + cx, f y/z + cy, "
                                       "f (x - baseline)/z + cx); information in this order.");
}

}  // namespace quiver::detail
