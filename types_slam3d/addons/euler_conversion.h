#pragma once

#include <quiver/core/graph/graph.h>

namespace quiver {

/// The graph with VERTEX3 and EDGE3, which TORO files hold, for VERTEX_SE3:QUAT and EDGE_SE3:QUAT. Estimates,
/// measurements, information, fixed directions, kernels, levels, comments and data lines are the same; other elements
/// stay. Throws GraphError if an edge of another type joins one of these vertices, if a measurement turns by half a
/// turn or pitches by a quarter turn, or if the registry lacks a type. O(size).
Graph withEulerAngles(const Graph& graph);

/// The inverse.
Graph withQuaternions(const Graph& graph);

}  // namespace quiver
