#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// The estimates of all vertices of a graph, and which of them have one.
class SavedEstimates {
 public:
  /// O(vertices).
  explicit SavedEstimates(const Graph& graph);
  /// Puts them back into the graph they are from. Throws GraphError, before anything is changed, if it has gained or
  /// lost vertices since, or if the estimate of one has another size.
  void restore(Graph& graph) const;

 private:
  struct Saved {
    std::int64_t id;
    int count;
    bool has;
  };
  std::vector<Saved> vertices_;
  std::vector<double> values_;
};

/// Puts a graph's estimates back when it goes, unless they were kept: a guess that fails, with whatever exception,
/// leaves them as they were. The graph must outlive it and keep its vertices.
class EstimatesGuard {
 public:
  explicit EstimatesGuard(Graph& graph) : graph_(&graph), saved_(graph) {}
  EstimatesGuard(const EstimatesGuard&) = delete;
  EstimatesGuard& operator=(const EstimatesGuard&) = delete;
  ~EstimatesGuard();
  void keep() { graph_ = nullptr; }

 private:
  Graph* graph_;
  SavedEstimates saved_;
};

/// Gives vertices of `to` the estimates that vertices of the same ids and classes have in `from`, whatever their
/// registries. Throws GraphError if the estimates of two are of different run-time sizes.
void copyEstimates(const Graph& from, Graph& to);

}  // namespace quiver
