#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <quiver/core/registry/registry.h>

namespace quiver {

/// Makes "gn", "lm" and "dogleg" known to a registry. Throws GraphError where a name is taken.
void registerAlgorithms(Registry& registry);

/// An algorithm of the registry or, in one that was filled without registerAlgorithms, of the library; nullptr if there
/// is none of that name.
const NamedEntry<Algorithm>* findAlgorithm(const Registry& registry, std::string_view name);

/// What Options::algorithm may be, "auto" first.
std::vector<std::string> algorithmNames(const Registry& registry);

}  // namespace quiver
