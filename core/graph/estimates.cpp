#include <quiver/core/graph/estimates.h>

#include <exception>
#include <utility>

#include <fmt/format.h>

#include <quiver/core/registry/element_types.h>
#include <quiver/core/util/error.h>

namespace quiver {

SavedEstimates::SavedEstimates(const Graph& graph) {
  vertices_.reserve(static_cast<std::size_t>(graph.vertexCount()));
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    const int count = type.valueCount(vertex);
    vertices_.push_back({vertex.id(), count, vertex.hasEstimate()});
    values_.insert(values_.end(), type.values(vertex), type.values(vertex) + count);
  });
}

void SavedEstimates::restore(Graph& graph) const {
  const Saved* saved = vertices_.data();
  const Saved* const end = saved + vertices_.size();
  std::as_const(graph).forEachVertex([&](const Vertex& vertex) {
    if (saved == end || saved->id != vertex.id() || saved->count != graph.typeOf(vertex).valueCount(vertex))
      throw GraphError(fmt::format("vertex {} is not as it was when estimates were saved", vertex.id()));
    ++saved;
  });
  if (saved != end) throw GraphError(fmt::format("vertex {} is gone since estimates were saved", saved->id));
  saved = vertices_.data();
  const double* values = values_.data();
  graph.forEachVertex([&](Vertex& vertex) {
    graph.typeOf(vertex).setValues(vertex, values);
    vertex.setHasEstimate(saved->has);
    values += saved->count;
    ++saved;
  });
}

EstimatesGuard::~EstimatesGuard() {
  if (graph_ == nullptr) return;
  try {
    saved_.restore(*graph_);
  } catch (const std::exception&) {
    // Vertices came or went: then there is nothing to go back to.
  }
}

void copyEstimates(const Graph& from, Graph& to) {
  from.forEachVertex([&](const Vertex& vertex) {
    if (!vertex.hasEstimate()) return;
    Vertex* const target = to.findVertex(vertex.id());
    const VertexType& type = from.typeOf(vertex);
    if (target == nullptr || to.typeOf(*target).cppName() != type.cppName()) return;
    if (to.typeOf(*target).valueCount(*target) != type.valueCount(vertex))
      throw GraphError(fmt::format("the estimates of vertex {} have {} and {} numbers", vertex.id(),
                                   type.valueCount(vertex), to.typeOf(*target).valueCount(*target)));
    to.typeOf(*target).setValues(*target, type.values(vertex));
  });
}

}  // namespace quiver
