#pragma once

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// A copy of the graph whose EDGE_SE3:QUAT measurements are EDGE_SE3:LOG edges with the same information matrices, so
/// that they are evaluated with the logarithm of the pose. Kernels and levels are kept, attached text is not.
Graph withLogarithmicEdges(const Graph& graph);

}  // namespace quiver::app
