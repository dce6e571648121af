#pragma once

#include <string>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// What is wrong with naming the type on the command line: that the graph has no edge (no vertex) of it, and which
/// types it has. Empty if it has one.
std::string missingType(const Graph& graph, const EdgeType& type);
std::string missingType(const Graph& graph, const VertexType& type);

}  // namespace quiver::app
