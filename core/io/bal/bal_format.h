#pragma once

#include <string_view>

#include <quiver/core/registry/registry.h>

namespace quiver::detail {

/// The element types that a file of "bundle adjustment in the large" holds, as a registry knows them.
struct BalTypes {
  const VertexType* camera = nullptr;
  const VertexType* point = nullptr;
  const EdgeType* observation = nullptr;

  /// Throws GraphError if the registry lacks one of them.
  explicit BalTypes(const Registry& registry);
};

/// Whether a text is such a file, not .g2o or TORO: it begins with a number, those with a tag.
bool looksLikeBal(std::string_view text);

}  // namespace quiver::detail
