#pragma once

#include <nlohmann/json_fwd.hpp>

namespace quiver::app {

/// Prints what `quiver info` found for people, from its JSON.
void printInfo(const nlohmann::ordered_json& json);

}  // namespace quiver::app
