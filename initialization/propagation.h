#pragma once

#include <cstdint>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Sets the estimates of all vertices that are no poses and are not held, from the poses, by the first edge in
/// canonical order that can tell each; what no edge can tell keeps its estimate. Returns their number. Throws
/// GraphError naming the first vertex that ends without an estimate.
std::int64_t propagateFromPoses(Graph& graph, const Options& options);

}  // namespace quiver
