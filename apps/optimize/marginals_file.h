#pragma once

#include <string>

#include <quiver/core/graph/graph.h>
#include <quiver/smoothing/marginals.h>

namespace quiver::app {

/// What `quiver optimize --marginals` writes: after comments, a line a vertex that was estimated, in ascending order of
/// ids: tag, id, and the upper triangle of its covariance, row by row, as information matrices stand in .g2o files.
/// Vertices that have none are named in comments.
std::string describeMarginals(const Marginals& marginals, const Graph& graph);

}  // namespace quiver::app
