#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3_projection.h>
#include <quiver/types_slam3d/register.h>

namespace quiver::detail {

void registerCameras3d(Registry& registry) {
  registry.addParameter<ParameterCamera>("PARAMS_CAMERACALIB",
                                         "Pinhole camera: its pose in the body, z forward, then "
                                         "fx fy cx cy.");
  registry.addParameter<ParameterStereoCamera>("PARAMS_STEREOCAMERACALIB",
                                               "Stereo camera: its pose in the body, z forward, then fx fy cx cy and "
                                               "the baseline.");
  registry.addEdge<EdgeSE3Disparity>("EDGE_PROJECT_DISPARITY",
                                     "Pixel and disparity of a point. With p = (X P)^-1 l: error (fx px/pz + cx, "
                                     "fy py/pz + cy, 1/pz) - z; the disparity is normalised, disparity / (fx "
                                     "baseline). Information in this order.");
  registry.addEdge<EdgeSE3Depth>("EDGE_PROJECT_DEPTH",
                                 "Pixel and depth of a point. With p = (X P)^-1 l: error (fx px/pz + cx, "
                                 "fy py/pz + cy, pz) - z; information in this order.");
}

}  // namespace quiver::detail
