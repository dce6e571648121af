#include <quiver/core/registry/registry.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/edge_se2_prior.h>
#include <quiver/types_slam2d/register.h>

namespace quiver::detail {

void registerPoses2d(Registry& registry) {
  registry.addVertex<VertexSE2>("VERTEX_SE2",
                                "Pose in the plane, body to world. Step: t += R rho, theta = wrap(theta + phi), in the "
                                "body's frame. The angle is kept as the file has it.");
  registry.addEdge<EdgeSE2>("EDGE_SE2",
                            "Pose of the second vertex seen from the first. Error Z^-1 (X1^-1 X2) as (x, y, theta), "
                            "theta in (-pi, pi]; information in this order.");
  registry.addEdge<EdgePriorSE2>("EDGE_PRIOR_SE2",
                                 "Pose measured in the world. Error Z^-1 X as (x, y, theta); information in this "
                                 "order.");
  registry.addEdge<EdgePriorSE2XY>("EDGE_PRIOR_SE2_XY",
                                   "Position of a pose measured in the world, as by GPS. Error t - z in the world's "
                                   "axes; information (x, y).");
}

}  // namespace quiver::detail
