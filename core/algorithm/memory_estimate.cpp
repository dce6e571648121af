#include <quiver/core/algorithm/memory_estimate.h>

#include <vector>

#include <quiver/core/algorithm/optimizer.h>

namespace quiver {
namespace {

/// A vertex in a problem beside its estimates: pointer, place in a state, variable, offsets, and its share of the table
/// of ids.
constexpr std::int64_t vertexBytes = 88;
/// An edge in a problem beside its numbers: pointers twice, first slot twice, a place in lists of all edges.
constexpr std::int64_t edgeBytes = 36;
/// And for each of its vertices: slots twice, the record in a state.
constexpr std::int64_t roleBytes = 16;
/// Vectors over all scalars that an algorithm and a linear system hold: step, damping, gradient, diagonal.
constexpr std::int64_t scalarBytes = 32;

std::int64_t stateBytes(int values) {
  const std::int64_t stride = values <= 2 ? values : values <= 4 ? 4 : (values + 7) / 8 * 8;
  return 2 * stride * 8;
}

}  // namespace

std::int64_t estimateCompilation(const Graph& graph, const Options& options) {
  std::int64_t bytes = 0;
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    bytes += vertexBytes + stateBytes(type.valueCount(vertex)) + scalarBytes * type.dimension(vertex);
  });
  std::vector<std::int64_t> numbers(graph.registry()->edgeTypes().size(), -1);
  graph.forEachEdge([&](const Edge& edge) {
    if (options.level >= 0 && edge.level() != options.level) return;
    const EdgeType& type = graph.typeOf(edge);
    std::int64_t& own = numbers[static_cast<std::size_t>(edge.type())];
    if (own < 0) own = static_cast<std::int64_t>(type.fields().size() + type.information(edge).size());
    bytes += edgeBytes + own * 8 + roleBytes * static_cast<std::int64_t>(edge.vertexIds().size());
  });
  return bytes;
}

std::int64_t estimateMemory(Graph& graph, const Options& options) {
  const std::int64_t compilation = estimateCompilation(graph, options);
  Options asked = options;
  asked.memoryLimit = compilation + 1;  // enough to compile, too little for any linear system
  asked.callback = {};
  return compilation + optimize(graph, asked).plan.bytes;
}

}  // namespace quiver
