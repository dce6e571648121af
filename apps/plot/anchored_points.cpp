#include <quiver/apps/plot/anchored_points.h>

#include <quiver/types_sba/edge_project_inverse_depth.h>

namespace quiver::app {
namespace {

/// A y with y = (ψ₁, ψ₂, 1) / ψ₃, A the anchor.
std::optional<Vector<double, 3>> placeOf(const Graph& graph, const Vertex& point, const Vertex& anchor) {
  const VertexType& type = graph.typeOf(anchor);
  if (!point.hasEstimate() || !anchor.hasEstimate() || !isPose(type.placeKind())) return std::nullopt;
  const double* psi = graph.typeOf(point).values(point);
  if (!(psi[2] > 0.0)) return std::nullopt;
  return type.place(type.values(anchor)) * Vector<double, 3>(psi[0] / psi[2], psi[1] / psi[2], 1.0 / psi[2]);
}

}  // namespace

std::unordered_map<std::int64_t, std::optional<Vector<double, 3>>> anchoredPoints(const Graph& graph) {
  constexpr int pointRole = 0, anchorRole = 2;
  const Registry& registry = *graph.registry();
  const EdgeType* psi = registry.findEdgeTypeByName(typeName<EdgeProjectPSI2UV>());
  const EdgeType* inverseDepth = registry.findEdgeTypeByName(typeName<EdgeProjectInverseDepth>());
  std::unordered_map<std::int64_t, std::optional<Vector<double, 3>>> places;
  graph.forEachEdge([&](const Edge& edge) {
    const EdgeType* type = &graph.typeOf(edge);
    if (type != psi && type != inverseDepth) return;
    const auto [entry, isNew] = places.try_emplace(edge.vertexId(pointRole));
    if (!isNew) return;
    entry->second =
        placeOf(graph, *graph.findVertex(edge.vertexId(pointRole)), *graph.findVertex(edge.vertexId(anchorRole)));
  });
  return places;
}

}  // namespace quiver::app
