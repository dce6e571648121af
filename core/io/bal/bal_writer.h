#pragma once

#include <string_view>

#include <quiver/core/graph/graph.h>
#include <quiver/core/util/function_ref.h>

namespace quiver::detail {

/// Throws GraphError unless a file of "bundle adjustment in the large" can hold the graph: vertices VERTEX_CAMERA:BAL
/// and VERTEX_TRACKXYZ, all with an estimate and free, edges EDGE_PROJECT_BAL of level 0 with information I and no
/// robust kernel, no parameters.
void checkBal(const Graph& graph);

/// Hands the text of such a file to `sink`, piece by piece: cameras and points in the order of their ids, observations
/// in the order in which they were added. The format has no ids, so they become 0, 1, …; comments and data lines are
/// left out. Throws GraphError as checkBal(), and if a number is not finite. The same bytes for any number of threads.
void writeBal(const Graph& graph, int threads, FunctionRef<void(std::string_view)> sink);

}  // namespace quiver::detail
