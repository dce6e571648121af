#include <quiver/core/problem/canonical_order.h>

#include <algorithm>
#include <numeric>

namespace quiver {
namespace {

/// Collects the numbers an element writes, for comparison.
class NumberCollector final : public FieldWriter {
 public:
  void real(double value) override { numbers.push_back(value); }
  void integer(std::int64_t value) override { numbers.push_back(static_cast<double>(value)); }
  void word(std::string_view value) override {
    for (const char c : value) numbers.push_back(c);
  }
  std::vector<double> numbers;
};

template <typename Range>
int compareRanges(const Range& a, const Range& b) {
  if (std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end())) return -1;
  return std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end()) ? 1 : 0;
}

bool contentLess(const Graph& graph, const Edge& a, const Edge& b) {
  const EdgeType& type = graph.typeOf(a);
  if (const int order = compareRanges(a.parameterIds(), b.parameterIds())) return order < 0;
  if (const int order = compareRanges(type.information(a), type.information(b))) return order < 0;
  NumberCollector first;
  NumberCollector second;
  type.write(a, first);
  type.write(b, second);
  if (const int order = compareRanges(first.numbers, second.numbers)) return order < 0;
  if (a.robustKernel().name() != b.robustKernel().name()) return a.robustKernel().name() < b.robustKernel().name();
  return a.robustKernel().width() < b.robustKernel().width();
}

}  // namespace

void sortVertices(const Graph& graph, std::vector<Vertex*>& vertices) {
  std::vector<int> rank(graph.registry()->vertexTypes().size());
  std::vector<int> byTag(rank.size());
  std::iota(byTag.begin(), byTag.end(), 0);
  std::sort(byTag.begin(), byTag.end(), [&](int a, int b) {
    return graph.registry()->vertexTypes()[static_cast<std::size_t>(a)]->tag() <
           graph.registry()->vertexTypes()[static_cast<std::size_t>(b)]->tag();
  });
  for (std::size_t i = 0; i < byTag.size(); ++i) rank[static_cast<std::size_t>(byTag[i])] = static_cast<int>(i);
  const auto less = [&](const Vertex* a, const Vertex* b) {
    const int rankA = rank[static_cast<std::size_t>(a->type())];
    const int rankB = rank[static_cast<std::size_t>(b->type())];
    return rankA != rankB ? rankA < rankB : a->id() < b->id();
  };
  if (!std::is_sorted(vertices.begin(), vertices.end(), less)) std::sort(vertices.begin(), vertices.end(), less);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
}

void sortEdges(const Graph& graph, std::vector<const Edge*>& edges) {
  const auto less = [&](const Edge* a, const Edge* b) {
    const int order = compareRanges(a->vertexIds(), b->vertexIds());
    return order != 0 ? order < 0 : (a != b && contentLess(graph, *a, *b));
  };
  if (!std::is_sorted(edges.begin(), edges.end(), less)) std::stable_sort(edges.begin(), edges.end(), less);
}

std::vector<int> edgeTypeOrder(const Registry& registry) {
  std::vector<int> order(registry.edgeTypes().size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return registry.edgeTypes()[static_cast<std::size_t>(a)]->tag() <
           registry.edgeTypes()[static_cast<std::size_t>(b)]->tag();
  });
  return order;
}

SlotTable::SlotTable(const std::vector<Vertex*>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) map_.insert(vertices[i]->id(), {0, static_cast<std::int32_t>(i)});
}

}  // namespace quiver
