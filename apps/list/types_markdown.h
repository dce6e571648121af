#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace quiver::app {

/// docs/types.md: the tables of `quiver list --json` about vertices, edges, parameters, aliases and data lines, with
/// the fields and units of every tag.
std::string typesAsMarkdown(const nlohmann::ordered_json& registry);

}  // namespace quiver::app
