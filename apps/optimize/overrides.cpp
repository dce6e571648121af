#include <quiver/apps/optimize/overrides.h>

#include <fmt/format.h>

#include <quiver/apps/optimize/named_types.h>
#include <quiver/core/util/error.h>

namespace quiver::app {

void Overrides::fix(const std::vector<std::int64_t>& ids) {
  for (const std::int64_t id : ids) {
    Vertex* vertex = graph_.findVertex(id);
    if (!vertex) throw GraphError(fmt::format("--fix {}: the graph has no vertex {}", id, id));
    fixed_.emplace_back(id, vertex->fixedDirections());
    vertex->setFixed(true);
  }
}

std::int64_t Overrides::setRobustKernels(const RobustChoice& kernel, const EdgeChoice& edges) {
  for (const EdgeType* type : edges.types()) {
    const std::string missing = missingType(graph_, *type);
    if (!missing.empty()) throw GraphError(fmt::format("--robust-edges {}: {}", type->tag(), missing));
  }
  std::int64_t chosen = 0;
  graph_.forEachEdge([&](Edge& edge) {
    kernels_.push_back(edge.robustKernel());
    if (!edges.contains(graph_, edge)) return;
    ++chosen;
    edge.setRobustKernel(kernel.kernelFor(graph_.typeOf(edge).errorDimension(edge)));
  });
  return chosen;
}

void Overrides::takeBack() {
  // Backwards: an id may have been named twice.
  for (auto it = fixed_.rbegin(); it != fixed_.rend(); ++it)
    graph_.findVertex(it->first)->setFixedDirections(it->second);
  fixed_.clear();
  if (kernels_.empty()) return;
  std::size_t next = 0;
  graph_.forEachEdge([&](Edge& edge) { edge.setRobustKernel(kernels_[next++]); });
  kernels_.clear();
}

}  // namespace quiver::app
