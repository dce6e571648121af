#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3_log.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerLogarithmicEdges(Registry& registry) {
  registry.addEdge<EdgeSE3Log>("EDGE_SE3:LOG",
                               "Pose of the second vertex seen from the first. Error ln(Z^-1 X1^-1 X2) as (rho, phi) "
                               "in metres and radians; information in this order. Jacobians with the exact inverse "
                               "right Jacobian of SE(3).");
  registry.addEdge<EdgeSE3LogApproximate>("EDGE_SE3:LOG_APPROXIMATE",
                                          "EDGE_SE3:LOG with the inverse right Jacobian approximated by "
                                          "I + [phi^ rho^; 0 phi^] / 2, to compare.");
}

}  // namespace quiver::detail
