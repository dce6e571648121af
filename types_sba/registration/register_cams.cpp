#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/edge_cam.h>
#include <quiver/types_sba/edge_project_cam.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerCams(Registry& registry) {
  registry.addVertex<VertexCam>("VERTEX_CAM",
                                "Camera in the world, z forward, with constant intrinsics of its own. Step: "
                                "X Exp(rho, phi), translation first.");
  registry.addVertex<VertexIntrinsics>(
      "VERTEX_INTRINSICS",
      "Intrinsics fx fy cx cy that are estimated, shared by any number of cameras; the "
      "baseline is carried along.");
  registry.addEdge<EdgeProjectP2MC>("EDGE_PROJECT_P2MC",
                                    "Pixel of a point in a camera. Error pi(X^-1 l) - z; information (u, v).");
  registry.addEdge<EdgeProjectP2SC>("EDGE_PROJECT_P2SC",
                                    "Pixel of a point in a stereo camera. Error (fx x/z + cx, fy y/z + cy, "
                                    "fx (x - baseline)/z + cx) less measured; information in this order.");
  registry.addEdge<EdgeProjectP2MCIntrinsics>("EDGE_PROJECT_P2MC_INTRINSICS",
                                              "EDGE_PROJECT_P2MC with the intrinsics of a third vertex instead of the "
                                              "camera's own; information (u, v).");
  registry.addEdge<EdgeCam>("EDGE_CAM",
                            "Pose of the second camera seen from the first. Error as EDGE_SE3:QUAT: translation and "
                            "vector part of the quaternion of Z^-1 X1^-1 X2; information in this order.");
  registry.addEdge<EdgeScale>("EDGE_SCALE", "Distance of two cameras. Error d - |t2 - t1|; information of it.");
}

}  // namespace quiver::detail
