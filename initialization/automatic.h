#pragma once

#include <limits>
#include <string>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

class Optimizer;

/// A start that was chosen among several.
struct AutomaticStart {
  /// "file", "tree", "chordal" or "points".
  std::string name;
  /// A sentence for the summary.
  std::string reason;
  /// chi2 of the first candidate, the graph's own estimates or the tree's; NaN if it was not asked.
  double firstChi2 = std::numeric_limits<double>::quiet_NaN();
};

/// The best start at hand: the graph's own estimates if every vertex has one, else a spanning tree's; and chordal
/// relaxation's, or what the registry's initialiser "points" makes of the better one, where chi2 is lower. A start that
/// explains all measurements within their noise already (chi2 at most the number of redundant ones) is kept without
/// looking further, and so is that of a graph without relative poses. Throws GraphError if an edge cannot tell a vertex
/// that has no estimate.
AutomaticStart automaticStart(Graph& graph, const Options& options = {});
/// The same; what is compiled to compare starts is left in the optimizer, which solves next.
AutomaticStart automaticStart(Graph& graph, Optimizer& optimizer);

/// automaticStart() as an initialiser: returns its sentence.
std::string automaticEstimate(Graph& graph, const Options& options = {});

}  // namespace quiver
