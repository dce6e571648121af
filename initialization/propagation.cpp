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

}  // namespace

std::int64_t propagateFromPoses(Graph& graph, const Options& options) {
  std::int64_t unset = 0;
  graph.forEachVertex([&](Vertex& vertex) {
    if (graph.typeOf(vertex).poseKind() != PoseKind::none || vertex.fixedDirections() != 0) return;
    vertex.setHasEstimate(false);
    ++unset;
  });
  if (unset == 0) return 0;
  std::vector<std::vector<const Edge*>> byType(graph.registry()->edgeTypes().size());
  std::as_const(graph).forEachEdge([&](const Edge& edge) {
    if (options.level < 0 || edge.level() == options.level)
      byType[static_cast<std::size_t>(edge.type())].push_back(&edge);
  });
  for (auto& edges : byType) sortEdges(graph, edges);
  const std::vector<int> order = edgeTypeOrder(*graph.registry());
  for (std::int64_t told = 1; told > 0;) {
    told = 0;
    for (const int type : order) {
      for (const Edge* edge : byType[static_cast<std::size_t>(type)]) told += tell(graph, *edge);
    }
  }
  std::as_const(graph).forEachVertex([&](const Vertex& vertex) {
    if (vertex.hasEstimate()) return;
    throw GraphError(fmt::format("no edge can tell where vertex {} ({}) is", vertex.id(), graph.typeOf(vertex).tag()));
  });
  return unset;
}

}  // namespace quiver
