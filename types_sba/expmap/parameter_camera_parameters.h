#pragma once

#include <quiver/core/graph/parameter.h>
#include <quiver/types_sba/stereo_camera.h>

namespace quiver {

/// Intrinsics that edges share: f, cx, cy [px], baseline [m] (g2o's PARAMS_CAMERAPARAMETERS, 1 0 0 0.5 unless given).
class ParameterCameraParameters : public BaseParameter<ParameterCameraParameters, Vector<double, 4>> {
 public:
  ParameterCameraParameters() { setValue(Vector<double, 4>(1.0, 0.0, 0.0, 0.5)); }
  static std::vector<Field> fields() {
    return {{"f", "px", ""}, {"cx", "px", ""}, {"cy", "px", ""}, {"baseline", "m", ""}};
  }
};

namespace detail {

template <typename S>
inline StereoCamera<S> stereoCamera(const Vector<S, 4>& k) {
  return {k[0], k[0], k[1], k[2], k[0] * k[3]};
}

}  // namespace detail

}  // namespace quiver
