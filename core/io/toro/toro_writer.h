#pragma once

#include <string_view>

#include <quiver/core/graph/graph.h>

namespace quiver::detail {

/// TORO's name of a type of the planar ones, or the tag itself.
std::string_view toroTag(std::string_view tag);

/// Throws GraphError, naming the first element that TORO has no line for. Its types are VERTEX_SE2, VERTEX_XY,
/// EDGE_SE2, EDGE_SE2_XY (if its information is that of a bearing and a range that do not depend on each other),
/// VERTEX3 and EDGE3.
void checkToro(const Graph& graph);

/// Writes what stands behind the ids of an edge's line: the inverse of what the reader does. BR's numbers come back
/// to rounding, everything else to the bit.
void writeToroEdge(const EdgeType& type, const Edge& edge, FieldWriter& writer);

}  // namespace quiver::detail
