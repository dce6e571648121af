#include <quiver/core/graph/estimates.h>

#include <quiver/core/registry/element_types.h>

namespace quiver {

SavedEstimates::SavedEstimates(const Graph& graph) {
  has_.reserve(static_cast<std::size_t>(graph.vertexCount()));
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    const double* values = type.values(vertex);
    values_.insert(values_.end(), values, values + type.valueCount(vertex));
    has_.push_back(vertex.hasEstimate() ? 1 : 0);
  });
}

void SavedEstimates::restore(Graph& graph) const {
  const double* values = values_.data();
  const char* has = has_.data();
  graph.forEachVertex([&](Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    type.setValues(vertex, values);
    vertex.setHasEstimate(*has++ != 0);
    values += type.valueCount(vertex);
  });
}

void copyEstimates(const Graph& from, Graph& to) {
  from.forEachVertex([&](const Vertex& vertex) {
    if (!vertex.hasEstimate()) return;
    Vertex* const target = to.findVertex(vertex.id());
    if (target != nullptr && target->type() == vertex.type())
      to.typeOf(*target).setValues(*target, from.typeOf(vertex).values(vertex));
  });
}

}  // namespace quiver
