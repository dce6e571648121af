#include <quiver/apps/optimize/named_types.h>

#include <cstdint>
#include <map>

#include <fmt/format.h>

namespace quiver::app {
namespace {

std::string describeMissing(const char* element, const char* elements, const std::string& tag,
                            const std::map<std::string, std::int64_t>& counts) {
  if (counts.contains(tag)) return "";
  std::string there;
  for (const auto& [other, count] : counts) there += fmt::format("{}{} {}", there.empty() ? "" : ", ", count, other);
  if (there.empty()) return fmt::format("the graph has no {}", elements);
  return fmt::format("the graph has no {} of the type {}; it has {}", element, tag, there);
}

}  // namespace

std::string missingType(const Graph& graph, const EdgeType& type) {
  std::map<std::string, std::int64_t> counts;
  graph.forEachEdge([&](const Edge& edge) { ++counts[graph.typeOf(edge).tag()]; });
  return describeMissing("edge", "edges", type.tag(), counts);
}

std::string missingType(const Graph& graph, const VertexType& type) {
  std::map<std::string, std::int64_t> counts;
  graph.forEachVertex([&](const Vertex& vertex) { ++counts[graph.typeOf(vertex).tag()]; });
  return describeMissing("vertex", "vertices", type.tag(), counts);
}

}  // namespace quiver::app
