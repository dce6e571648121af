#include <quiver/core/registry/registry.h>
#include <quiver/types_slam2d/edge_se2_offset.h>
#include <quiver/types_slam2d/register.h>

namespace quiver::detail {

void registerOffsets2d(Registry& registry) {
  registry.addParameter<ParameterSE2Offset>("PARAMS_SE2OFFSET", "Pose of a sensor in the body.");
  registry.addEdge<EdgeSE2Offset>("EDGE_SE2_OFFSET",
                                  "Pose of one sensor seen from another. Error Z^-1 (X1 P1)^-1 (X2 P2) as "
                                  "(x, y, theta); information in this order.");
  registry.addEdge<EdgeSE2XYOffset>("EDGE_SE2_POINTXY_OFFSET",
                                    "Point seen by a sensor. Error (X P)^-1 l - z in the sensor's axes; information "
                                    "(x, y). (g2o leaves the sensor's pose P out of the error.)");
  registry.addEdge<EdgeSE2XYCalibration>("EDGE_SE2_XY_CALIB",
                                         "Point seen by a sensor whose pose C in the body is the third vertex. Error "
                                         "(X C)^-1 l - z; information (x, y).");
}

}  // namespace quiver::detail
