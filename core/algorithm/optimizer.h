#pragma once

#include <quiver/core/algorithm/options.h>
#include <quiver/core/algorithm/summary.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Moves the estimates of a graph's free vertices to a minimum of its cost Σ ρ(eᵀΩe), starting from the estimates it has.
///
/// Solvers are found in the graph's registry. On return the graph holds the best estimate met, whatever the status; fixed vertices are
/// unchanged to the last bit. Throws GraphError for options or graphs that make no sense (a vertex without estimate, an unknown solver);
/// numerical outcomes are in the summary. Runs in options.threads threads; distinct graphs may be optimised at the same time.
[[nodiscard]] Summary optimize(Graph& graph, const Options& options = {});

}  // namespace quiver
