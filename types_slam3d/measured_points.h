#pragma once

#include <string>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// An initial guess for poses that see points by a pixel and a depth or disparity (EDGE_PROJECT_DEPTH,
/// EDGE_PROJECT_DISPARITY): each such edge measures a whole point, so it is taken for one that does
/// (EDGE_SE3_TRACKXYZ), weighed in all directions as in the worst known one, and that graph is optimised from the
/// estimates at hand. Pixels of a point that a poor estimate has beside or behind the camera lead nowhere; the point
/// itself always does.
///
/// Sets the estimates and returns a sentence. Throws GraphError, with the graph unchanged, if it has no such edge or a
/// vertex without an estimate.
std::string measuredPointsEstimate(Graph& graph, const Options& options = {});

}  // namespace quiver
