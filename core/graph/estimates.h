#pragma once

#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// The estimates of all vertices of a graph, and which of them have one.
class SavedEstimates {
 public:
  /// O(vertices).
  explicit SavedEstimates(const Graph& graph);
  /// Puts them back into the graph they are from, which must have gained and lost no vertex since.
  void restore(Graph& graph) const;

 private:
  std::vector<double> values_;
  std::vector<char> has_;
};

/// Gives vertices of `to` the estimates that vertices of the same ids and types have in `from`.
void copyEstimates(const Graph& from, Graph& to);

}  // namespace quiver
