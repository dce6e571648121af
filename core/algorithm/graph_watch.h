#pragma once

#include <string_view>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// Tells whether a graph gained, lost or changed elements, estimates aside, while somebody else's function ran: what
/// was compiled from it points into it.
class GraphWatch {
 public:
  explicit GraphWatch(const Graph& graph) : graph_(graph), stamp_(graph.stamp()), revision_(graph.revision()) {}

  bool unchanged() const { return graph_.stamp() == stamp_ && graph_.revision() == revision_; }
  /// Throws GraphError, naming who was called, if the graph has changed.
  void require(std::string_view who) const;

 private:
  const Graph& graph_;
  std::pair<std::int64_t, std::int64_t> stamp_;
  std::uint64_t revision_;
};

}  // namespace quiver
