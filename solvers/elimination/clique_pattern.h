#pragma once

#include <utility>
#include <vector>

#include <quiver/solvers/elimination/elimination_plan.h>

namespace quiver {

/// The kept vertices of every point, ascending and once each, in the order of the plan's groups and lanes.
struct PointNeighbours {
  std::vector<std::int64_t> begin;
  std::vector<std::int32_t> kept;

  PointNeighbours() = default;
  /// O(incidences).
  explicit PointNeighbours(const EliminationPlan& plan);

  int points() const { return static_cast<int>(begin.size()) - 1; }
  std::span<const std::int32_t> of(int point) const {
    const auto first = static_cast<std::size_t>(begin[static_cast<std::size_t>(point)]);
    return {kept.data() + first, static_cast<std::size_t>(begin[static_cast<std::size_t>(point) + 1]) - first};
  }
};

/// Pairs of kept vertices that one edge joins, larger index first; repeated.
std::vector<std::pair<int, int>> directPairs(const EliminationPlan& plan);

/// The blocks of the reduced matrix S, in the kept vertices' own order: `direct` pairs and those that share a point.
/// O(Σ k² over points with k neighbours).
BlockPattern cliquePattern(const BlockLayout& layout, const PointNeighbours& neighbours,
                           const std::vector<std::pair<int, int>>& direct);

}  // namespace quiver
