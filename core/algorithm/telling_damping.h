#pragma once

namespace quiver::detail {

/// λ up to which a step that brings little tells of an optimum. Under more damping every step is short, whatever the
/// estimate.
constexpr double mostTellingDamping = 1e6;

}  // namespace quiver::detail
