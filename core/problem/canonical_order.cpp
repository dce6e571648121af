#include <quiver/core/problem/canonical_order.h>

#include <algorithm>
#include <numeric>
#include <span>

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

/// An edge and its first two vertices, so that most comparisons do not reach for the edge.
struct EdgeIds {
  std::int64_t first = 0;
  std::int64_t second = 0;
  const Edge* edge = nullptr;

  bool operator<(const EdgeIds& other) const {
    if (first != other.first) return first < other.first;
    if (second != other.second) return second < other.second;
    return (edge->arity() > 2 || other.edge->arity() > 2) &&
           compareRanges(edge->vertexIds(), other.edge->vertexIds()) < 0;
  }
};

/// An edge and the numbers of its line, kept in a common buffer; the first of them here, since it mostly decides.
struct EdgeContent {
  double first = 0.0;
  std::size_t begin = 0;
  std::size_t end = 0;
  const Edge* edge = nullptr;
};

/// Sorts edges of one type and the same vertices by what they measure. The lines are written once an edge, not once a
/// comparison. O(edges log edges).
void sortByContent(const Graph& graph, std::span<const Edge*> edges) {
  NumberCollector lines;
  std::vector<EdgeContent> contents;
  contents.reserve(edges.size());
  for (const Edge* edge : edges) {
    const EdgeType& type = graph.typeOf(*edge);
    const std::size_t begin = lines.numbers.size();
    type.write(*edge, lines);
    type.writeTail(*edge, lines);
    const std::size_t end = lines.numbers.size();
    contents.push_back({begin < end ? lines.numbers[begin] : 0.0, begin, end, edge});
  }
  const auto numbers = [&](const EdgeContent& content) {
    return std::span(lines.numbers).subspan(content.begin, content.end - content.begin);
  };
  const auto less = [&](const EdgeContent& a, const EdgeContent& b) {
    if (a.first != b.first) return a.first < b.first;
    if (const int order = compareRanges(numbers(a), numbers(b))) return order < 0;
    if (const int order = compareRanges(a.edge->parameterIds(), b.edge->parameterIds())) return order < 0;
    const EdgeType& type = graph.typeOf(*a.edge);
    if (const int order = compareRanges(type.information(*a.edge), type.information(*b.edge))) return order < 0;
    const RobustKernel &first = a.edge->robustKernel(), &second = b.edge->robustKernel();
    if (first.name() != second.name()) return first.name() < second.name();
    return first.width() < second.width();
  };
  std::stable_sort(contents.begin(), contents.end(), less);
  std::transform(contents.begin(), contents.end(), edges.begin(), [](const EdgeContent& c) { return c.edge; });
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
  std::vector<EdgeIds> keys;
  keys.reserve(edges.size());
  for (const Edge* edge : edges) {
    const auto ids = edge->vertexIds();
    keys.push_back({ids[0], ids.size() > 1 ? ids[1] : -1, edge});
  }
  if (!std::is_sorted(keys.begin(), keys.end())) std::stable_sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size(); ++i) edges[i] = keys[i].edge;
  for (std::size_t begin = 0, end = 1; begin < edges.size(); begin = end++) {
    while (end < edges.size() && !(keys[begin] < keys[end])) ++end;
    if (end - begin > 1) sortByContent(graph, std::span(edges).subspan(begin, end - begin));
  }
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
