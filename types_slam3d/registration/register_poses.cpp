#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3.h>
#include <quiver/types_slam3d/edge_se3_prior.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerPoses3d(Registry& registry) {
  registry.addVertex<VertexSE3>("VERTEX_SE3:QUAT",
                                "Pose in space, body to world. Step: X Exp(rho, phi), body frame, translation first. "
                                "The quaternion is normalised on reading only if it is not of unit length.");
  registry.addParameter<ParameterSE3Offset>("PARAMS_SE3OFFSET", "Pose of a sensor in the body.");
  registry.addEdge<EdgeSE3>("EDGE_SE3:QUAT",
                            "Pose of the second vertex seen from the first. Error: translation and vector part of the "
                            "quaternion (scalar part >= 0, about half the angle) of Z^-1 X1^-1 X2; information in this "
                            "order.");
  registry.addEdge<EdgeSE3Prior>("EDGE_SE3_PRIOR",
                                 "Pose of a sensor measured in the world. Error: translation and vector part of the "
                                 "quaternion of Z^-1 X P; information in this order. The initial estimate is Z P^-1 "
                                 "(g2o uses P^-1 Z).");
  registry.addEdge<EdgeSE3XYZPrior>("EDGE_SE3_XYZ_PRIOR",
                                    "Position of a sensor measured in the world, as by GPS. Error X t_P - z in the "
                                    "world's axes; information (x, y, z). (g2o leaves the sensor's position t_P out.)");
}

}  // namespace quiver::detail
