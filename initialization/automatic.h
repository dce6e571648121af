#pragma once

#include <string>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// The best start at hand: the graph's own estimates if every vertex has one, else a spanning tree's; and chordal
/// relaxation's instead where its chi2 is lower. Returns a sentence for the summary. Throws GraphError if an edge
/// cannot tell a vertex that has no estimate.
std::string automaticEstimate(Graph& graph, const Options& options = {});

}  // namespace quiver
