#include <quiver/initialization/propagation.h>

#include <fmt/format.h>

#include <quiver/core/problem/canonical_order.h>
#include <quiver/core/util/error.h>

namespace quiver {
namespace {

/// Lets an edge tell one vertex that is not known yet, if all its others are; whether it did.
bool tell(Graph& graph, const Edge& edge) {
  std::uint64_t known = 0;
  int unknown = -1;
  for (int role = 0; role < edge.arity(); ++role) {
    if (graph.findVertex(edge.vertexId(role))->hasEstimate()) {
      known |= std::uint64_t{1} << std::min(role, 63);
    } else if (unknown >= 0) {
      return false;
    } else {
      unknown = role;
    }
  }
  return unknown >= 0 && graph.typeOf(edge).initialEstimate(edge, graph, known, unknown);
}

/// Lets edges, type by type, tell what is not known until no edge can tell more.
void tellAll(Graph& graph, const std::vector<std::vector<const Edge*>>& byType, const std::vector<int>& order) {
  for (std::int64_t told = 1; told > 0;) {
    told = 0;
    for (const int type : order) {
      for (const Edge* edge : byType[static_cast<std::size_t>(type)]) told += tell(graph, *edge);
    }
  }
}

}  // namespace

std::int64_t propagateFromPoses(Graph& graph, const Options& options) {
  std::vector<Vertex*> unset;
  std::vector<Vertex*> had;  // an estimate before
  graph.forEachVertex([&](Vertex& vertex) {
    if (graph.typeOf(vertex).poseKind() != PoseKind::none || vertex.fixedDirections() != 0) return;
    unset.push_back(&vertex);
    if (vertex.hasEstimate()) had.push_back(&vertex);
    vertex.setHasEstimate(false);
  });
  if (unset.empty()) return 0;
  std::vector<std::vector<const Edge*>> byType(graph.registry()->edgeTypes().size());
  std::as_const(graph).forEachEdge([&](const Edge& edge) {
    if (options.level < 0 || edge.level() == options.level)
      byType[static_cast<std::size_t>(edge.type())].push_back(&edge);
  });
  for (auto& edges : byType) sortEdges(graph, edges);
  const std::vector<int> order = edgeTypeOrder(*graph.registry());
  tellAll(graph, byType, order);
  // Types that no edge tells, as intrinsics, keep what they had, and others may be told from there.
  std::vector<char> told(graph.registry()->vertexTypes().size(), 0);
  for (const Vertex* vertex : unset) {
    if (vertex->hasEstimate()) told[static_cast<std::size_t>(vertex->type())] = 1;
  }
  for (Vertex* vertex : had) {
    if (!told[static_cast<std::size_t>(vertex->type())]) vertex->setHasEstimate(true);
  }
  tellAll(graph, byType, order);
  for (Vertex* vertex : had) vertex->setHasEstimate(true);
  std::as_const(graph).forEachVertex([&](const Vertex& vertex) {
    if (vertex.hasEstimate()) return;
    throw GraphError(fmt::format("no edge can tell where vertex {} ({}) is, and it has no estimate", vertex.id(),
                                 graph.typeOf(vertex).tag()));
  });
  return static_cast<std::int64_t>(unset.size());
}

}  // namespace quiver
