#include <quiver/core/registry/registry.h>
#include <quiver/types_sba/expmap/edge_se3_project_xyz.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerExpmapProjections(Registry& registry) {
  registry.addEdge<EdgeSE3ProjectXYZ>("EDGE_SE3_PROJECT_XYZ:EXPMAP",
                                      "Pixel of a point. Error z - (fx x/z + cx, fy y/z + cy); information (u, v). The "
                                      "intrinsics, which g2o does not write, stand behind it; 1 1 0.5 0.5 if missing.");
  registry.addEdge<EdgeStereoSE3ProjectXYZ>(
      "EDGE_STEREO_SE3_PROJECT_XYZ:EXPMAP",
      "Pixel of a point in a stereo camera. Error z - (u, v, u - bf/z); "
      "information in this order. fx fy cx cy bf, which g2o does not write, stand "
      "behind it.");
  registry.addEdge<EdgeSE3ProjectXYZOnlyPose>(
      "EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP",
      "Pixel of a known point. Error z - (fx x/z + cx, fy y/z + cy); information "
      "(u, v). fx fy cx cy and the point, which g2o does not write, stand behind "
      "it.");
  registry.addEdge<EdgeStereoSE3ProjectXYZOnlyPose>(
      "EDGE_STEREO_SE3_PROJECT_XYZONLYPOSE:EXPMAP",
      "Known point in a stereo camera. Error z - (u, v, u - bf/z); "
      "information in this order. fx fy cx cy bf and the point, which g2o "
      "does not write, stand behind it.");
}

}  // namespace quiver::detail
