#include <quiver/initialization/incidence.h>

#include <numeric>
#include <utility>

#include <quiver/core/problem/canonical_order.h>

namespace quiver::detail {

std::vector<const Edge*> Incidence::canonicalEdges(const Graph& graph, int level) {
  std::vector<std::vector<const Edge*>> byType(graph.registry()->edgeTypes().size());
  graph.forEachEdge([&](const Edge& edge) {
    if (level < 0 || edge.level() == level) byType[static_cast<std::size_t>(edge.type())].push_back(&edge);
  });
  std::vector<const Edge*> edges;
  for (const int type : edgeTypeOrder(*graph.registry())) {
    auto& list = byType[static_cast<std::size_t>(type)];
    sortEdges(graph, list);
    edges.insert(edges.end(), list.begin(), list.end());
  }
  return edges;
}

Incidence::Incidence(std::vector<const Edge*> edges, const std::vector<Vertex*>& vertices) : edges_(std::move(edges)) {
  const SlotTable places(vertices);
  touchingBegin_.assign(vertices.size() + 1, 0);
  for (const Edge* edge : edges_) {
    for (const std::int64_t id : edge->vertexIds()) {
      ends_.push_back(places.find(id));
      ++touchingBegin_[static_cast<std::size_t>(ends_.back()) + 1];
    }
    endsBegin_.push_back(static_cast<std::int64_t>(ends_.size()));
  }
  std::partial_sum(touchingBegin_.begin(), touchingBegin_.end(), touchingBegin_.begin());
  std::vector<std::int64_t> next(touchingBegin_.begin(), touchingBegin_.end() - 1);
  touching_.resize(ends_.size());
  for (int edge = 0; edge < this->edges(); ++edge) {
    for (const std::int32_t vertex : verticesOf(edge))
      touching_[static_cast<std::size_t>(next[static_cast<std::size_t>(vertex)]++)] = edge;
  }
}

}  // namespace quiver::detail
