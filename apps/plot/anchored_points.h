#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>

#include <quiver/core/graph/graph.h>
#include <quiver/geometry/linear.h>

namespace quiver::app {

/// Vertices that hold ψ = (x/z, y/z, 1/z) in the frame of an anchor, which their measurements tell, by id: where they
/// are in the world; nowhere if one of the two has no estimate, or ψ₃ is not positive. O(edges).
std::unordered_map<std::int64_t, std::optional<Vector<double, 3>>> anchoredPoints(const Graph& graph);

}  // namespace quiver::app
