#pragma once

#include <cstdint>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Sets the estimates of all vertices that are no poses and are not held, from the poses, by the first edge in
/// canonical order that can tell each; what no edge can tell keeps its estimate. Held are fixed directions, and, if
/// only some vertices are free, the others that have an estimate. Returns the number of vertices told. Throws
/// GraphError naming the first vertex that ends without an estimate, and WorkStopped once `options` ask to stop;
/// estimates are then in between. O((vertices + edges) log edges).
std::int64_t propagateFromPoses(Graph& graph, const Options& options);

}  // namespace quiver
