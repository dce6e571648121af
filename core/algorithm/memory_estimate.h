#pragma once

#include <cstdint>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Bytes that compiling a graph takes beside the graph at its peak: estimates twice, measurements, lists of vertices
/// and edges. Counted from types and numbers of elements. O(vertices + edges).
std::int64_t estimateCompilation(const Graph& graph, const Options& options);

/// Bytes that `optimize` takes beside the graph at its peak, within a quarter for problems of more than some megabytes.
/// Compiles the graph and analyses its structure, but allocates neither matrices nor factors; leaves the graph
/// unchanged. Throws as `optimize` does.
std::int64_t estimateMemory(Graph& graph, const Options& options = {});

}  // namespace quiver
