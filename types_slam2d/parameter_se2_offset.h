#pragma once

#include <quiver/core/graph/parameter.h>

namespace quiver {

/// The pose of a sensor in the body (g2o's PARAMS_SE2OFFSET).
class ParameterSE2Offset : public BaseParameter<ParameterSE2Offset, SE2<double>> {};

}  // namespace quiver
