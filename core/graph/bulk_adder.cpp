#include <quiver/core/graph/bulk_adder.h>

#include <numeric>

namespace quiver::detail {
namespace {

template <typename Base>
std::int64_t slotsOf(const std::vector<std::unique_ptr<ElementPool<Base>>>& pools, std::size_t type) {
  return type < pools.size() && pools[type] ? pools[type]->slots() : 0;
}

}  // namespace

BulkAdder::BulkAdder(Graph& graph, std::vector<ElementCounts> parts)
    : graph_(graph),
      totals_(*graph.registry()),
      vertexPools_(totals_.vertices.size(), nullptr),
      edgePools_(totals_.edges.size(), nullptr) {
  ElementCounts slots(*graph.registry());
  for (std::size_t t = 0; t < slots.vertices.size(); ++t) slots.vertices[t] = slotsOf(graph.vertices_, t);
  for (std::size_t t = 0; t < slots.edges.size(); ++t) slots.edges[t] = slotsOf(graph.edges_, t);
  named_ = slots.vertices;
  const auto advance = [](std::vector<std::int64_t>& slot, std::vector<std::int64_t>& total,
                          const std::vector<std::int64_t>& count) {
    for (std::size_t t = 0; t < count.size(); ++t) {
      slot[t] += count[t];
      total[t] += count[t];
    }
  };
  parts_.reserve(parts.size());
  for (ElementCounts& counts : parts) {
    parts_.push_back({std::move(counts), slots});
    advance(slots.vertices, totals_.vertices, parts_.back().counts.vertices);
    advance(slots.edges, totals_.edges, parts_.back().counts.edges);
  }
}

/// Slots that have no element yet get one: then the pools can be destroyed.
BulkAdder::~BulkAdder() {
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    if (!parts_[part].begun) begin(part);
  }
}

bool BulkAdder::nameVertex(int type, std::int64_t id) {
  if (graph_.vertexIds_.find(id).valid()) return false;
  const std::int64_t slot = named_[static_cast<std::size_t>(type)]++;
  graph_.vertexIds_.insert(id, {type, static_cast<std::int32_t>(slot)});
  return true;
}

void BulkAdder::open() {
  for (std::size_t t = 0; t < totals_.vertices.size(); ++t) {
    if (totals_.vertices[t] == 0) continue;
    ElementPool<Vertex>& pool = graph_.vertexPool(static_cast<int>(t));
    pool.append(totals_.vertices[t]);
    vertexPools_[t] = &pool;
  }
  for (std::size_t t = 0; t < totals_.edges.size(); ++t) {
    if (totals_.edges[t] == 0) continue;
    ElementPool<Edge>& pool = *graph_.shapeOf(*graph_.registry()->edgeTypes()[t]).pool;
    pool.append(totals_.edges[t]);
    edgePools_[t] = &pool;
  }
}

void BulkAdder::begin(std::size_t part) noexcept {
  Part& own = parts_[part];
  own.begun = true;
  for (std::size_t t = 0; t < vertexPools_.size(); ++t) {
    if (vertexPools_[t]) vertexPools_[t]->construct(own.slots.vertices[t], own.counts.vertices[t]);
  }
  for (std::size_t t = 0; t < edgePools_.size(); ++t) {
    if (edgePools_[t]) edgePools_[t]->construct(own.slots.edges[t], own.counts.edges[t]);
  }
}

Vertex& BulkAdder::addVertex(std::size_t part, int type, std::int64_t id) {
  const auto t = static_cast<std::size_t>(type);
  Vertex& vertex = vertexPools_[t]->at(parts_[part].slots.vertices[t]++);
  graph_.initialize(vertex, type, id);
  return vertex;
}

Edge& BulkAdder::addEdge(std::size_t part, int type, std::span<const std::int64_t> vertices,
                         std::span<const std::int64_t> parameters) {
  const auto t = static_cast<std::size_t>(type);
  const EdgeType& descriptor = *graph_.registry()->edgeTypes()[t];
  const Graph::EdgeShape& shape = graph_.shapes_[t];
  graph_.check(descriptor, shape, vertices, parameters);
  const std::int64_t slot = parts_[part].slots.edges[t]++;
  Edge& edge = edgePools_[t]->at(slot);
  graph_.initialize(edge, type, slot, vertices, parameters);
  return edge;
}

void BulkAdder::finish() {
  graph_.edgeCount_ += std::accumulate(totals_.edges.begin(), totals_.edges.end(), std::int64_t{0});
}

}  // namespace quiver::detail
