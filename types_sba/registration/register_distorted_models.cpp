#include <quiver/types_sba/models/register_model.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerDistortedCameraModels(Registry& registry) {
  registerModel<ParameterBrown, VertexBrown, EdgeProjectBrown, EdgeProjectBrownIntrinsics>(
      registry, "BROWN", "a camera with radial and tangential distortion (Brown and Conrady), z forward.");
  registerModel<ParameterFisheye, VertexFisheye, EdgeProjectFisheye, EdgeProjectFisheyeIntrinsics>(
      registry, "FISHEYE", "a fisheye camera (Kannala and Brandt), z forward.");
}

}  // namespace quiver::detail
