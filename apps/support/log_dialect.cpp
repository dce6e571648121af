#include <quiver/apps/support/log_dialect.h>

#include <vector>

#include <quiver/types_slam3d/edge_se3.h>
#include <quiver/types_slam3d/edge_se3_log.h>

namespace quiver::app {

Graph withLogarithmicEdges(const Graph& graph) {
  Graph copy(graph);
  const EdgeType* quaternionType = graph.registry()->findEdgeTypeByName(typeName<EdgeSE3>());
  std::vector<EdgeSE3*> edges;
  copy.forEachEdge([&](Edge& edge) {
    if (&copy.typeOf(edge) == quaternionType) edges.push_back(static_cast<EdgeSE3*>(&edge));
  });
  for (EdgeSE3* edge : edges) {
    auto& logarithmic = copy.addEdge<EdgeSE3Log>(edge->vertexIds(), edge->measurement(), edge->information());
    logarithmic.setRobustKernel(edge->robustKernel());
    logarithmic.setLevel(edge->level());
    copy.removeEdge(*edge);
  }
  return copy;
}

}  // namespace quiver::app
