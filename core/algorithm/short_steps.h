#pragma once

#include <string_view>

namespace quiver::detail {

/// λ up to which a step that brings little tells of an optimum. Under more damping every step is short, whatever the
/// estimate.
constexpr double mostTellingDamping = 1e6;
/// Why a descent ends where no step lowers the cost, however short.
constexpr std::string_view stalledReason =
    "no step lowers the cost, however short: an error that jumps there, or a wrong Jacobian; checkJacobians(graph) "
    "tells which";

}  // namespace quiver::detail
