#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// Sorts vertices by tag, then id, and drops repetitions. O(n) when sorted already.
void sortVertices(const Graph& graph, std::vector<Vertex*>& vertices);

/// Sorts edges of one type by vertex ids, then parameter ids, information and the numbers of the measurement, so that
/// the order in which equal edges were added does not matter. O(n) when sorted already.
void sortEdges(const Graph& graph, std::vector<const Edge*>& edges);

/// Indices of a registry's edge types, all or those given, by tag.
std::vector<int> edgeTypeOrder(const Registry& registry);
std::vector<int> edgeTypeOrder(const Registry& registry, std::vector<int> types);

/// From vertex ids to positions in a list.
class SlotTable {
 public:
  explicit SlotTable(const std::vector<Vertex*>& vertices);
  std::int32_t find(std::int64_t id) const { return map_.find(id).slot; }

 private:
  IdMap map_;
};

}  // namespace quiver
