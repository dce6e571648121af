#pragma once

#include <cstdint>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// Adds wrong loop closures to a pose graph: `fraction` times as many as it has right ones (EDGE_SE2 and EDGE_SE3:QUAT
/// between ids that are not consecutive), rounded. Each joins two poses drawn at random that no edge joins yet, with
/// the measurement and the information of a right one drawn at random: what a place recognition that takes one place
/// for another would report. The same edges for the same seed everywhere. Returns how many were added. Throws
/// GraphError if fraction is negative or not finite, or the graph has no loop closure or no room for so many.
std::int64_t addWrongLoops(Graph& graph, double fraction, std::uint64_t seed);

}  // namespace quiver::app
