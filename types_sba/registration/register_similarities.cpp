#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/register.h>
#include <quiver/types_sba/sim3/edge_sim3.h>

namespace quiver::detail {

void registerSimilarities(Registry& registry) {
  registry.addVertex<VertexSim3Expmap>("VERTEX_SIM3:EXPMAP",
                                       "Similarity G, camera to world, by its logarithm, rotation first; intrinsics of "
                                       "two cameras, of which g2o writes the first. Step: G Exp(rho, phi, sigma).");
  registry.addEdge<EdgeSim3Expmap>("EDGE_SIM3:EXPMAP",
                                   "Similarity Z of the second vertex seen from the first. Error ln(Z^-1 G1^-1 G2), "
                                   "rotation first; information (phi, rho, sigma).");
  registry.addEdge<EdgeProjectSim3>("EDGE_PROJECT_SIM3_XYZ:EXPMAP",
                                    "Pixel of a point in the first camera. Error z - pi(G^-1 l); information (u, v).");
  registry.addEdge<EdgeProjectInverseSim3>("EDGE_PROJECT_INVERSE_SIM3_XYZ:EXPMAP",
                                           "Pixel of a point in the second camera. Error z - pi(G l); information "
                                           "(u, v).");
}

}  // namespace quiver::detail
