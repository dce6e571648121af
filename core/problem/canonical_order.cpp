#include <quiver/core/problem/canonical_order.h>

#include <algorithm>
#include <bit>
#include <cmath>
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
  bool more = false;

  bool operator<(const EdgeIds& other) const {
    if (first != other.first) return first < other.first;
    if (second != other.second) return second < other.second;
    return (more || other.more) && compareRanges(edge->vertexIds(), other.edge->vertexIds()) < 0;
  }
};

/// Sorts stably by one of the two ids, in one pass over a table of them. False, and nothing done, if they are spread so
/// far that the table would be larger than the edges. O(edges).
bool sortByTable(std::vector<EdgeIds>& keys, std::int64_t EdgeIds::*id) {
  const auto [least, most] =
      std::minmax_element(keys.begin(), keys.end(), [id](const auto& a, const auto& b) { return a.*id < b.*id; });
  const std::int64_t lowest = (*least).*id;
  const std::uint64_t range = static_cast<std::uint64_t>((*most).*id) - static_cast<std::uint64_t>(lowest);
  if (range > 2 * keys.size()) return false;
  const auto row = [&](const EdgeIds& key) { return static_cast<std::size_t>(key.*id - lowest); };
  std::vector<std::uint32_t> end(static_cast<std::size_t>(range) + 2, 0);
  for (const EdgeIds& key : keys) ++end[row(key) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<EdgeIds> sorted(keys.size());
  for (const EdgeIds& key : keys) sorted[end[row(key)]++] = key;
  keys.swap(sorted);
  return true;
}

/// Sorts edges by their vertices; few have more than two.
void sortById(std::vector<EdgeIds>& keys) {
  const auto more = [](const EdgeIds& key) { return key.more; };
  const bool pairs = std::none_of(keys.begin(), keys.end(), more);
  if (pairs && sortByTable(keys, &EdgeIds::second) && sortByTable(keys, &EdgeIds::first)) return;
  std::stable_sort(keys.begin(), keys.end());
}

/// An edge and the first number of what it measures, as an integer in the same order.
struct EdgeContent {
  std::uint64_t key = 0;
  const Edge* edge = nullptr;
  std::size_t bucket = 0;
};

/// Bits of a double that compare as the numbers do; not a number has a place too.
std::uint64_t orderedBits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  constexpr std::uint64_t sign = std::uint64_t{1} << 63;
  return (bits & sign) != 0 ? ~bits : bits | sign;
}

double valueOf(std::uint64_t ordered) {
  constexpr std::uint64_t sign = std::uint64_t{1} << 63;
  return std::bit_cast<double>((ordered & sign) != 0 ? ordered ^ sign : ~ordered);
}

int compareNumbers(std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const std::uint64_t first = orderedBits(a[i]), second = orderedBits(b[i]);
    if (first != second) return first < second ? -1 : 1;
  }
  return a.size() == b.size() ? 0 : (a.size() < b.size() ? -1 : 1);
}

/// Orders edges of one type by what they measure and how it is weighed.
class ContentOrder {
 public:
  explicit ContentOrder(const EdgeType& type) : type_(&type) {}

  EdgeContent contentOf(const Edge& edge) const {
    const std::span<const double> numbers = type_->measurement(edge);
    if (!numbers.empty()) return {orderedBits(numbers[0]), &edge};
    const std::vector<double> line = lineOf(edge);
    return {line.empty() ? 0 : orderedBits(line[0]), &edge};
  }

  bool operator()(const EdgeContent& a, const EdgeContent& b) const {
    if (a.key != b.key) return a.key < b.key;
    if (const int order = compareNumbers(type_->measurement(*a.edge), type_->measurement(*b.edge))) return order < 0;
    if (const int order = compareRanges(a.edge->parameterIds(), b.edge->parameterIds())) return order < 0;
    if (const int order = compareNumbers(type_->information(*a.edge), type_->information(*b.edge))) return order < 0;
    const RobustKernel &first = a.edge->robustKernel(), &second = b.edge->robustKernel();
    if (first.name() != second.name()) return first.name() < second.name();
    if (first.width() != second.width()) return first.width() < second.width();
    if (first.shape() != second.shape()) return first.shape() < second.shape();
    // A type may keep more than these numbers: its line tells.
    return compareNumbers(lineOf(*a.edge), lineOf(*b.edge)) < 0;
  }

 private:
  std::vector<double> lineOf(const Edge& edge) const {
    NumberCollector line;
    type_->write(edge, line);
    type_->writeTail(edge, line);
    return std::move(line.numbers);
  }

  const EdgeType* type_;
};

/// Sorts by content: first into as many buckets as there are edges, evenly over the range of their first numbers, which
/// leaves few edges a bucket. O(edges) then, O(edges log edges) at worst.
void sortContents(std::vector<EdgeContent>& contents, const ContentOrder& order) {
  constexpr std::size_t few = 32;
  const auto [least, most] =
      std::minmax_element(contents.begin(), contents.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  const double lowest = valueOf(least->key);
  const double scale = static_cast<double>(contents.size() - 1) / (valueOf(most->key) - lowest);
  if (contents.size() <= few || !std::isfinite(scale) || scale == 0.0) {
    std::sort(contents.begin(), contents.end(), order);
    return;
  }
  std::vector<std::uint32_t> end(contents.size() + 1, 0);
  for (EdgeContent& content : contents) {
    // Rounding keeps the order of numbers, so no edge of a bucket belongs into an earlier one.
    content.bucket = std::min(static_cast<std::size_t>((valueOf(content.key) - lowest) * scale), contents.size() - 1);
    ++end[content.bucket + 1];
  }
  for (std::size_t bucket = 1; bucket < end.size(); ++bucket) end[bucket] += end[bucket - 1];
  std::vector<EdgeContent> sorted(contents.size());
  // What begins a bucket moves to where it ends.
  for (const EdgeContent& content : contents) sorted[end[content.bucket]++] = content;
  std::size_t begin = 0;
  for (const std::uint32_t last : end) {
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin);
    if (last - begin == 2 && order(first[1], first[0])) std::swap(first[0], first[1]);
    if (last - begin > 2) std::sort(first, sorted.begin() + last, order);
    begin = last;
  }
  contents.swap(sorted);
}

/// Sorts edges of one type and the same vertices.
void sortByContent(const Graph& graph, std::span<const Edge*> edges) {
  const ContentOrder order(graph.typeOf(*edges[0]));
  std::vector<EdgeContent> contents;
  contents.reserve(edges.size());
  for (const Edge* edge : edges) contents.push_back(order.contentOf(*edge));
  sortContents(contents, order);
  std::transform(contents.begin(), contents.end(), edges.begin(), [](const EdgeContent& c) { return c.edge; });
}

bool joinTheSame(const std::vector<const Edge*>& edges) {
  const auto first = edges[0]->vertexIds();
  const auto same = [first](const Edge* edge) {
    const auto ids = edge->vertexIds();
    return ids.size() == first.size() && ids[0] == first[0] && std::ranges::equal(ids.subspan(1), first.subspan(1));
  };
  return std::all_of(edges.begin() + 1, edges.end(), same);
}

}  // namespace

void sortVertices(const Graph& graph, std::vector<Vertex*>& vertices) {
  std::vector<int> rank(graph.registry()->vertexTypes().size(), -1);
  std::vector<int> byTag;
  for (const Vertex* vertex : vertices) {
    int& own = rank[static_cast<std::size_t>(vertex->type())];
    if (own < 0) byTag.push_back(vertex->type());
    own = 0;
  }
  const auto tag = [&](int type) -> const std::string& {
    return graph.registry()->vertexTypes()[static_cast<std::size_t>(type)]->tag();
  };
  std::sort(byTag.begin(), byTag.end(), [&](int a, int b) { return tag(a) < tag(b); });
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
  if (edges.size() < 2) return;
  if (joinTheSame(edges)) return sortByContent(graph, edges);
  std::vector<EdgeIds> keys;
  keys.reserve(edges.size());
  for (const Edge* edge : edges) {
    const auto ids = edge->vertexIds();
    keys.push_back({ids[0], ids.size() > 1 ? ids[1] : -1, edge, ids.size() > 2});
  }
  if (!std::is_sorted(keys.begin(), keys.end())) sortById(keys);
  for (std::size_t i = 0; i < keys.size(); ++i) edges[i] = keys[i].edge;
  for (std::size_t begin = 0, end = 1; begin < edges.size(); begin = end++) {
    while (end < edges.size() && !(keys[begin] < keys[end])) ++end;
    if (end - begin > 1) sortByContent(graph, std::span(edges).subspan(begin, end - begin));
  }
}

std::vector<int> edgeTypeOrder(const Registry& registry) {
  std::vector<int> types(registry.edgeTypes().size());
  std::iota(types.begin(), types.end(), 0);
  return edgeTypeOrder(registry, std::move(types));
}

std::vector<int> edgeTypeOrder(const Registry& registry, std::vector<int> types) {
  const auto tag = [&](int type) -> const std::string& {
    return registry.edgeTypes()[static_cast<std::size_t>(type)]->tag();
  };
  std::sort(types.begin(), types.end(), [&](int a, int b) { return tag(a) < tag(b); });
  return types;
}

SlotTable::SlotTable(const std::vector<Vertex*>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) map_.insert(vertices[i]->id(), {0, static_cast<std::int32_t>(i)});
}

}  // namespace quiver
