#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::detail {

/// Which edges join which vertices, both ways. Edges and vertices are known by their places in two lists.
class Incidence {
 public:
  /// The edges of a level (of all, if it is negative), type by type, in canonical order. O(edges log edges).
  static std::vector<const Edge*> canonicalEdges(const Graph& graph, int level);

  Incidence() = default;
  /// `vertices` has every vertex of the edges. O(edges + vertices).
  Incidence(std::vector<const Edge*> edges, const std::vector<Vertex*>& vertices);

  int edges() const { return static_cast<int>(edges_.size()); }
  const Edge& edge(int i) const { return *edges_[static_cast<std::size_t>(i)]; }
  /// In the order of the edge's roles.
  std::span<const std::int32_t> verticesOf(int edge) const { return listOf(ends_, endsBegin_, edge); }
  /// Ascending.
  std::span<const std::int32_t> edgesOf(int vertex) const { return listOf(touching_, touchingBegin_, vertex); }

 private:
  static std::span<const std::int32_t> listOf(const std::vector<std::int32_t>& all,
                                              const std::vector<std::int64_t>& begin, int i) {
    const auto at = static_cast<std::size_t>(i);
    return {all.data() + begin[at], all.data() + begin[at + 1]};
  }

  std::vector<const Edge*> edges_;
  std::vector<std::int32_t> ends_;
  std::vector<std::int64_t> endsBegin_{0};
  std::vector<std::int32_t> touching_;
  std::vector<std::int64_t> touchingBegin_;
};

}  // namespace quiver::detail
