#pragma once

#include <quiver/core/registry/registry.h>

namespace quiver::app {

/// Adds the linear solver "cholmod", whose library is loaded when a graph is first solved with it: CHOLMOD and the BLAS
/// beneath it take longer to load than a small graph takes to solve. Adds nothing in a build without CHOLMOD. Solving
/// throws PluginError if the library is not beside quiver's.
void addCholmodOnDemand(Registry& registry);

}  // namespace quiver::app
