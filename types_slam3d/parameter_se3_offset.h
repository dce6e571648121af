#pragma once

#include <quiver/core/graph/parameter.h>

namespace quiver {

/// The pose of a sensor in the body (g2o's PARAMS_SE3OFFSET).
class ParameterSE3Offset : public BaseParameter<ParameterSE3Offset, SE3<double>> {};

}  // namespace quiver
