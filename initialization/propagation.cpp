#include <quiver/initialization/propagation.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <span>

#include <fmt/format.h>

#include <quiver/core/util/error.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/initialization/incidence.h>

namespace quiver {
namespace {

/// Edges tell, one after the other in canonical order, again and again from the first, what is not known yet; those
/// that cannot, as more than one of their vertices is unknown, are not looked at. O((vertices + edges) log edges).
class Propagation {
 public:
  Propagation(Graph& graph, const Options& options)
      : graph_(graph), stop_(options.timeLimit, options.stopToken), free_(options.free) {
    std::sort(free_.begin(), free_.end());
    graph.forEachVertex([&](Vertex& vertex) { vertices_.push_back(&vertex); });
    incidence_ = detail::Incidence(detail::Incidence::canonicalEdges(graph, options.level), vertices_);
  }

  /// The number of vertices that edges told.
  std::int64_t run() {
    forget();
    countUnknown();
    tellAll();
    // Types that no edge tells, as intrinsics, keep what they had, and others may be told from there.
    std::vector<char> told(graph_.registry()->vertexTypes().size(), 0);
    for (const int vertex : unset_) {
      if (known_[at(vertex)]) told[at(vertices_[at(vertex)]->type())] = 1;
    }
    for (const int vertex : unset_) {
      if (!had_[at(vertex)] || told[at(vertices_[at(vertex)]->type())]) continue;
      vertices_[at(vertex)]->setHasEstimate(true);
      settle(vertex, -1);
    }
    tellAll();
    for (const int vertex : unset_) {
      if (had_[at(vertex)]) vertices_[at(vertex)]->setHasEstimate(true);
    }
    return told_;
  }

 private:
  using Queue = std::priority_queue<int, std::vector<int>, std::greater<>>;

  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  /// Takes what is to be told for unknown.
  void forget() {
    for (int i = 0; i < static_cast<int>(vertices_.size()); ++i) {
      Vertex& vertex = *vertices_[at(i)];
      const bool chosen = free_.empty() || std::binary_search(free_.begin(), free_.end(), vertex.id());
      const bool held = vertex.fixedDirections() != 0 || (!chosen && vertex.hasEstimate());
      had_.push_back(vertex.hasEstimate());
      if (!held && graph_.typeOf(vertex).poseKind() == PoseKind::none) {
        unset_.push_back(i);
        vertex.setHasEstimate(false);
      }
      known_.push_back(vertex.hasEstimate());
    }
  }

  void countUnknown() {
    for (int edge = 0; edge < incidence_.edges(); ++edge) {
      const auto ends = incidence_.verticesOf(edge);
      unknown_.push_back(static_cast<int>(std::ranges::count_if(ends, [&](int end) { return !known_[at(end)]; })));
      if (unknown_.back() == 1) now_.push(edge);
    }
  }

  void tellAll() {
    constexpr int patience = 256;
    for (int looks = 1; !now_.empty() || !later_.empty(); ++looks) {
      if (looks % patience == 0) stop_.throwIfReached();
      if (now_.empty()) std::swap(now_, later_);
      const int edge = now_.top();
      now_.pop();
      if (unknown_[at(edge)] == 1) tell(edge);
    }
  }

  void tell(int index) {
    const Edge& edge = incidence_.edge(index);
    const std::span<const std::int32_t> ends = incidence_.verticesOf(index);
    std::uint64_t known = 0;
    int to = 0;
    for (int role = 0; role < edge.arity(); ++role) {
      if (known_[at(ends[at(role)])]) {
        known |= std::uint64_t{1} << std::min(role, 63);
      } else {
        to = role;
      }
    }
    if (!graph_.typeOf(edge).initialEstimate(edge, graph_, known, to)) return;
    ++told_;
    settle(ends[at(to)], index);
  }

  /// A vertex has become known by an edge, or −1: edges behind that one get their turn at once, others in the next.
  void settle(int vertex, int by) {
    known_[at(vertex)] = 1;
    for (const std::int32_t edge : incidence_.edgesOf(vertex)) {
      if (--unknown_[at(edge)] == 1) (edge > by ? now_ : later_).push(edge);
    }
  }

  Graph& graph_;
  StopCondition stop_;
  std::vector<std::int64_t> free_;
  std::vector<Vertex*> vertices_;
  detail::Incidence incidence_;
  std::vector<char> had_;  // an estimate before
  std::vector<char> known_;
  std::vector<int> unset_;    // vertices to be told
  std::vector<int> unknown_;  // vertices of each edge
  Queue now_;
  Queue later_;
  std::int64_t told_ = 0;
};

}  // namespace

std::int64_t propagateFromPoses(Graph& graph, const Options& options) {
  const std::int64_t told = Propagation(graph, options).run();
  std::as_const(graph).forEachVertex([&](const Vertex& vertex) {
    if (vertex.hasEstimate()) return;
    throw GraphError(fmt::format("no edge can tell where vertex {} ({}) is, and it has no estimate", vertex.id(),
                                 graph.typeOf(vertex).tag()));
  });
  return told;
}

}  // namespace quiver
