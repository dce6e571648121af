#include <quiver/apps/info/bridges.h>

#include <algorithm>
#include <unordered_map>

namespace quiver::app {
namespace {

/// Vertices and edges as the nodes of one graph, in which a vertex is a neighbour of its edges. A bridge is a node of
/// an edge whose removal disconnects: found by Tarjan's depth-first search, which numbers nodes in order of discovery
/// and keeps for each the lowest number that its subtree reaches.
class Search {
 public:
  explicit Search(const Graph& graph) {
    graph.forEachVertex([&](const Vertex& vertex) { index_.emplace(vertex.id(), vertices_++); });
    graph.forEachEdge([&](const Edge& edge) { edges_.push_back(&edge); });
    connect();
    number_.assign(nodes(), 0);
    lowest_.assign(nodes(), 0);
    size_.assign(nodes(), 0);
    heaviestBelow_.assign(edges_.size(), 0);
    cutBelow_.assign(edges_.size(), 0);
  }

  Connections run() {
    Connections result;
    std::int64_t components = 0;
    for (std::size_t root = 0; root < vertices_; ++root) {
      if (number_[root] != 0) continue;
      ++components;
      const std::size_t firstEdge = order_.size();
      visit(root);
      for (std::size_t i = firstEdge; i < order_.size(); ++i) collect(order_[i], size_[root], result.bridges);
    }
    std::int64_t ends = 0;
    for (const Edge* edge : edges_) ends += edge->arity() - 1;
    result.independentCycles = ends - (static_cast<std::int64_t>(vertices_) - components);
    std::sort(result.bridges.begin(), result.bridges.end(), [](const Bridge& a, const Bridge& b) {
      if (a.cutOff != b.cutOff) return a.cutOff > b.cutOff;
      const auto x = a.edge->vertexIds(), y = b.edge->vertexIds();
      return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
    });
    return result;
  }

 private:
  std::size_t nodes() const { return vertices_ + edges_.size(); }

  void connect() {
    begin_.assign(nodes() + 1, 0);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      for (const std::int64_t id : edges_[e]->vertexIds()) {
        ++begin_[index_.at(id) + 1];
        ++begin_[vertices_ + e + 1];
      }
    }
    for (std::size_t i = 0; i < nodes(); ++i) begin_[i + 1] += begin_[i];
    neighbours_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      for (const std::int64_t id : edges_[e]->vertexIds()) {
        const std::size_t vertex = index_.at(id);
        neighbours_[next[vertex]++] = vertices_ + e;
        neighbours_[next[vertices_ + e]++] = vertex;
      }
    }
  }

  struct Frame {
    std::size_t node;
    std::size_t parent;
    std::size_t next;
  };

  void enter(std::size_t node, std::size_t parent, std::vector<Frame>& stack) {
    number_[node] = lowest_[node] = ++count_;
    size_[node] = node < vertices_ ? 1 : 0;
    if (node >= vertices_) order_.push_back(node - vertices_);
    stack.push_back({node, parent, begin_[node]});
  }

  void visit(std::size_t root) {
    std::vector<Frame> stack;
    enter(root, nodes(), stack);
    while (!stack.empty()) {
      Frame& frame = stack.back();
      const std::size_t node = frame.node;
      if (frame.next < begin_[node + 1]) {
        const std::size_t other = neighbours_[frame.next++];
        if (other == frame.parent) continue;
        if (number_[other] != 0) {
          lowest_[node] = std::min(lowest_[node], number_[other]);
        } else {
          enter(other, node, stack);
        }
        continue;
      }
      const std::size_t parent = frame.parent;
      stack.pop_back();
      if (parent != nodes()) leave(node, parent);
    }
  }

  void leave(std::size_t node, std::size_t parent) {
    lowest_[parent] = std::min(lowest_[parent], lowest_[node]);
    size_[parent] += size_[node];
    if (parent < vertices_ || lowest_[node] < number_[parent]) return;
    // Nothing below this vertex leads round the edge above it.
    std::int64_t& heaviest = heaviestBelow_[parent - vertices_];
    heaviest = std::max(heaviest, size_[node]);
    cutBelow_[parent - vertices_] += size_[node];
  }

  void collect(std::size_t edge, std::int64_t component, std::vector<Bridge>& bridges) const {
    if (cutBelow_[edge] == 0) return;
    const std::int64_t rest = component - cutBelow_[edge];
    bridges.push_back({edges_[edge], component - std::max(rest, heaviestBelow_[edge])});
  }

  std::unordered_map<std::int64_t, std::size_t> index_;
  std::size_t vertices_ = 0;
  std::vector<const Edge*> edges_;
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> neighbours_;
  std::int64_t count_ = 0;
  std::vector<std::int64_t> number_;
  std::vector<std::int64_t> lowest_;
  /// Vertices in the subtree.
  std::vector<std::int64_t> size_;
  /// Of the subtrees that an edge alone holds: the largest, and all together.
  std::vector<std::int64_t> heaviestBelow_;
  std::vector<std::int64_t> cutBelow_;
  /// Edges as discovered.
  std::vector<std::size_t> order_;
};

}  // namespace

Connections findBridges(const Graph& graph) { return Search(graph).run(); }

}  // namespace quiver::app
