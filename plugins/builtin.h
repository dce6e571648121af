#pragma once

#include <memory>

#include <quiver/core/registry/registry.h>

namespace quiver {

/// A new registry with everything the library brings: the types of planar and spatial SLAM, the robust kernels, the
/// linear systems "auto", "block", "dense" and "eigen", the algorithms and the initialisers. To be filled further as
/// wanted; an ordinary object, so two of them know nothing of each other.
std::shared_ptr<Registry> builtinRegistry();

/// Makes the library's linear systems and initialisers known to a registry. Throws GraphError where a name is taken.
/// (The rest: registerSlam2d, registerSlam3d, registerSba, registerRobustKernels, registerAlgorithms in their folders.)
void registerLinearSystems(Registry& registry);
void registerInitializers(Registry& registry);

}  // namespace quiver
