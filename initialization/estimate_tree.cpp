#include <quiver/initialization/estimate_tree.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <quiver/core/graph/estimates.h>
#include <quiver/core/problem/canonical_order.h>
#include <quiver/core/registry/field_tokens.h>
#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

/// Roles beyond this do not fit into the mask of known vertices.
constexpr int mostRoles = 64;

}  // namespace

EstimateTree::EstimateTree(Graph& graph, const Options& options, Length length) : graph_(graph), length_(length) {
  std::vector<std::int64_t> free = options.free;
  std::sort(free.begin(), free.end());
  std::vector<const Edge*> edges = Incidence::canonicalEdges(graph, options.level);
  collectVertices(edges, free);
  incidence_ = Incidence(std::move(edges), vertices_);
  findComponents();
  start();
}

void EstimateTree::start() {
  unknown_.clear();
  for (int edge = 0; edge < incidence_.edges(); ++edge) unknown_.push_back(incidence_.edge(edge).arity());
  known_.assign(vertices_.size(), 0);
  rooted_.assign(vertices_.size(), 0);
  distance_.assign(vertices_.size(), 0.0);
  depth_.assign(vertices_.size(), 0);
  heap_.clear();
  roots_.clear();
  told_ = kept_ = 0;
  firstKept_ = -1;
}

void EstimateTree::collectVertices(const std::vector<const Edge*>& edges, const std::vector<std::int64_t>& free) {
  for (const Edge* edge : edges) {
    for (const std::int64_t id : edge->vertexIds()) vertices_.push_back(graph_.findVertex(id));
  }
  sortVertices(graph_, vertices_);
  held_.reserve(vertices_.size());
  for (const Vertex* vertex : vertices_) {
    const bool chosen = free.empty() || std::binary_search(free.begin(), free.end(), vertex->id());
    held_.push_back(!chosen || vertex->fixedDirections() != 0);
  }
}

void EstimateTree::findComponents() {
  std::vector<std::int32_t> parent(vertices_.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto find = [&](std::int32_t v) {
    while (parent[static_cast<std::size_t>(v)] != v) {
      auto& up = parent[static_cast<std::size_t>(v)];
      up = parent[static_cast<std::size_t>(up)];
      v = up;
    }
    return v;
  };
  for (int edge = 0; edge < incidence_.edges(); ++edge) {
    const auto ends = incidence_.verticesOf(edge);
    for (const std::int32_t vertex : ends) parent[static_cast<std::size_t>(find(vertex))] = find(ends[0]);
  }
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(vertices_.size()); ++v) componentOf_.push_back(find(v));
  estimated_.assign(vertices_.size(), 0);
  posesFirst_.assign(vertices_.size(), 0);
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (vertices_[v]->hasEstimate()) estimated_[static_cast<std::size_t>(componentOf_[v])] = 1;
  }
}

bool EstimateTree::later(const Candidate& a, const Candidate& b) const {
  const auto key = [this](const Candidate& c) {
    return std::tuple(c.distance, c.edges, vertices_[static_cast<std::size_t>(c.vertex)]->id(), c.edge);
  };
  return key(a) > key(b);
}

void EstimateTree::offer(const Candidate& candidate) {
  heap_.push_back(candidate);
  std::push_heap(heap_.begin(), heap_.end(), [this](const Candidate& a, const Candidate& b) { return later(a, b); });
}

bool EstimateTree::isFullPrior(int edge) const {
  const Edge& prior = incidence_.edge(edge);
  if (prior.arity() != 1) return false;
  const EdgeType& type = graph_.typeOf(prior);
  const Vertex& vertex = *vertices_[static_cast<std::size_t>(incidence_.verticesOf(edge)[0])];
  const int n = type.errorDimension(prior);
  if (n < graph_.typeOf(vertex).dimension(vertex)) return false;
  const std::span<const double> triangle = type.information(prior);
  Eigen::MatrixXd information(n, n);
  std::size_t k = 0;
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c) information(r, c) = information(c, r) = triangle[k++];
  }
  const Eigen::VectorXd pivots = information.ldlt().vectorD();
  return pivots.minCoeff() > 1e-14 * pivots.maxCoeff();
}

void EstimateTree::seed() {
  for (int v = 0; v < static_cast<int>(vertices_.size()); ++v) {
    if (held_[static_cast<std::size_t>(v)] && vertices_[static_cast<std::size_t>(v)]->hasEstimate()) plant(v);
  }
  for (int edge = 0; edge < incidence_.edges(); ++edge) {
    if (!isFullPrior(edge)) continue;
    const Edge& prior = incidence_.edge(edge);
    offer({length_(graph_.typeOf(prior), prior), 1, incidence_.verticesOf(edge)[0], edge});
  }
}

void EstimateTree::plant(int vertex) {
  Vertex& root = *vertices_[static_cast<std::size_t>(vertex)];
  auto& rooted = rooted_[static_cast<std::size_t>(componentOf_[static_cast<std::size_t>(vertex)])];
  if (rooted && !held_[static_cast<std::size_t>(vertex)]) {
    ++kept_;
    if (firstKept_ < 0) firstKept_ = vertex;
  } else {
    roots_.push_back(root.id());
  }
  rooted = 1;
  settle({0.0, 0, vertex, -1});
}

void EstimateTree::settle(const Candidate& candidate) {
  const auto v = static_cast<std::size_t>(candidate.vertex);
  known_[v] = 1;
  distance_[v] = candidate.distance;
  depth_[v] = candidate.edges;
  for (const std::int32_t edge : incidence_.edgesOf(candidate.vertex)) {
    if (--unknown_[static_cast<std::size_t>(edge)] != 1) continue;
    Candidate next{0.0, 0, -1, edge};
    for (const std::int32_t end : incidence_.verticesOf(edge)) {
      if (!known_[static_cast<std::size_t>(end)]) {
        next.vertex = end;
        continue;
      }
      next.distance = std::max(next.distance, distance_[static_cast<std::size_t>(end)]);
      next.edges = std::max(next.edges, depth_[static_cast<std::size_t>(end)] + 1);
    }
    const Edge& along = incidence_.edge(edge);
    next.distance += length_(graph_.typeOf(along), along);
    offer(next);
  }
}

bool EstimateTree::tell(const Candidate& candidate) {
  const Edge& edge = incidence_.edge(candidate.edge);
  if (edge.arity() > mostRoles) return false;
  std::uint64_t known = 0;
  int to = 0;
  const auto ends = incidence_.verticesOf(candidate.edge);
  for (int role = 0; role < edge.arity(); ++role) {
    if (ends[static_cast<std::size_t>(role)] == candidate.vertex) {
      to = role;
    } else {
      known |= std::uint64_t{1} << role;
    }
  }
  return graph_.typeOf(edge).initialEstimate(edge, graph_, known, to);
}

void EstimateTree::drain() {
  const auto order = [this](const Candidate& a, const Candidate& b) { return later(a, b); };
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), order);
    const Candidate candidate = heap_.back();
    heap_.pop_back();
    const auto v = static_cast<std::size_t>(candidate.vertex);
    if (known_[v] || !tell(candidate)) continue;
    ++told_;
    rooted_[static_cast<std::size_t>(componentOf_[v])] = 1;
    settle(candidate);
  }
}

bool EstimateTree::putAtOrigin(int vertex) {
  Vertex& root = *vertices_[static_cast<std::size_t>(vertex)];
  const VertexType& type = graph_.typeOf(root);
  type.setToOrigin(root);
  TokenWriter line;
  type.write(root, line);
  try {
    TokenReader reader(line.tokens());
    type.read(reader, root);
  } catch (const ParseError&) {
    root.setHasEstimate(false);
    return false;
  }
  return true;
}

std::vector<std::int32_t> EstimateTree::rootOrder() const {
  std::vector<std::int32_t> order(vertices_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto rank = [this](std::int32_t v) {
    const Vertex& vertex = *vertices_[static_cast<std::size_t>(v)];
    const VertexType& type = graph_.typeOf(vertex);
    const bool noPose = !isPose(type.placeKind());
    const bool missing = !vertex.hasEstimate();
    const bool posesFirst = posesFirst_[static_cast<std::size_t>(componentOf_[static_cast<std::size_t>(v)])] != 0;
    return std::tuple(posesFirst ? noPose : missing, posesFirst ? missing : noPose, !held_[static_cast<std::size_t>(v)],
                      -type.dimension(vertex), vertex.id());
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return rank(a) < rank(b); });
  return order;
}

void EstimateTree::plantRemaining() {
  for (const std::int32_t v : rootOrder()) {
    const auto at = static_cast<std::size_t>(v);
    if (known_[at]) continue;
    const auto component = static_cast<std::size_t>(componentOf_[at]);
    const bool missing = !vertices_[at]->hasEstimate();
    if (missing && (rooted_[component] || !putAtOrigin(v))) continue;
    const std::int64_t before = told_;
    plant(v);
    drain();
    // An origin of its own choice beside estimates that it tells nothing about is no estimate.
    if (missing && estimated_[component] && told_ == before) known_[at] = 0;
  }
}

bool EstimateTree::posesMissBesideEstimates() const {
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (!vertices_[v]->hasEstimate() && estimated_[static_cast<std::size_t>(componentOf_[v])] &&
        isPose(graph_.typeOf(*vertices_[v]).placeKind()))
      return true;
  }
  return false;
}

bool EstimateTree::preferPoses() {
  bool changed = false;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    const auto component = static_cast<std::size_t>(componentOf_[v]);
    if (known_[v] || !estimated_[component] || posesFirst_[component] ||
        !isPose(graph_.typeOf(*vertices_[v]).placeKind()))
      continue;
    posesFirst_[component] = 1;
    changed = true;
  }
  return changed;
}

void EstimateTree::checkAllKnown() const {
  std::int64_t count = 0;
  const Vertex* first = nullptr;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (known_[v]) continue;
    ++count;
    if (!first || vertices_[v]->id() < first->id()) first = vertices_[v];
  }
  if (count == 0) return;
  throw GraphError(
      fmt::format("no edge tells where vertex {} ({}) is{}: give it an estimate, or its edges' type an "
                  "initialEstimate",
                  first->id(), graph_.typeOf(*first).tag(),
                  count == 1 ? "" : fmt::format(", nor {} other{}", count - 1, count == 2 ? "" : "s")));
}

void EstimateTree::growOnce() {
  seed();
  drain();
  plantRemaining();
}

void EstimateTree::grow() {
  std::optional<SavedEstimates> before;
  if (posesMissBesideEstimates()) before.emplace(graph_);
  growOnce();
  if (before && preferPoses()) {
    before->restore(graph_);
    start();
    growOnce();
  }
  checkAllKnown();
  std::sort(roots_.begin(), roots_.end());
}

std::string EstimateTree::describe(const std::string& name) const {
  constexpr std::size_t mostNamed = 5;
  std::string from;
  for (std::size_t i = 0; i < std::min(mostNamed, roots_.size()); ++i)
    from += fmt::format("{}{}", from.empty() ? "" : ", ", roots_[i]);
  if (roots_.size() > mostNamed) from += fmt::format(" and {} more", roots_.size() - mostNamed);
  std::string text = fmt::format("{} tells {} vert{}", name, told_, told_ == 1 ? "ex" : "ices");
  if (!roots_.empty()) text += fmt::format(", from vert{} {}", roots_.size() == 1 ? "ex" : "ices", from);
  if (kept_ > 0) {
    const Vertex& first = *vertices_[static_cast<std::size_t>(firstKept_)];
    text += fmt::format("; no edge tells {} other{}, which keep{} {} estimate (vertex {}, {}{})", kept_,
                        kept_ == 1 ? "" : "s", kept_ == 1 ? "s" : "", kept_ == 1 ? "its" : "their", first.id(),
                        graph_.typeOf(first).tag(), kept_ == 1 ? "" : ", the first");
  }
  return text;
}

}  // namespace quiver::detail
