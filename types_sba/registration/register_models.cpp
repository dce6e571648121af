#include <quiver/types_sba/models/register_model.h>
#include <quiver/types_sba/register.h>

namespace quiver::detail {

void registerCameraModels(Registry& registry) {
  registerModel<ParameterPinhole, VertexPinhole, EdgeProjectPinhole, EdgeProjectPinholeIntrinsics>(
      registry, "PINHOLE", "a pinhole camera, z forward.");
  registerModel<ParameterSnavely, VertexSnavely, EdgeProjectSnavely, EdgeProjectSnavelyIntrinsics>(
      registry, "SNAVELY", "a camera that looks along -z with radial distortion f (1 + k1 r^2 + k2 r^4).");
}

}  // namespace quiver::detail
