#include <quiver/solvers/elimination/clique_pattern.h>

#include <algorithm>
#include <array>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;

}  // namespace

PointNeighbours::PointNeighbours(const EliminationPlan& plan) {
  begin.push_back(0);
  std::array<std::vector<std::int32_t>, lanes> own;
  for (int g = 0; g < plan.pointGroups(); ++g) {
    const EliminationPlan::Group& group = plan.groups()[static_cast<std::size_t>(g)];
    for (auto& list : own) list.clear();
    for (int r = group.rowBegin; r < group.rowEnd; ++r) {
      const EliminationPlan::Row& row = plan.rows()[static_cast<std::size_t>(r)];
      const std::size_t count = plan.kinds()[static_cast<std::size_t>(row.kind)].keptRoles.size() * lanes;
      const std::int32_t* incident = plan.incidences().data() + row.incidences;
      for (std::size_t i = 0; i < count; ++i) {
        if (incident[i] >= 0) own[i % lanes].push_back(incident[i]);
      }
    }
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if ((group.lanes >> lane & 1) == 0) continue;
      auto& list = own[lane];
      if (!std::is_sorted(list.begin(), list.end())) std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      kept.insert(kept.end(), list.begin(), list.end());
      begin.push_back(static_cast<std::int64_t>(kept.size()));
    }
  }
}

std::vector<std::pair<int, int>> directPairs(const EliminationPlan& plan) {
  std::vector<std::pair<int, int>> pairs;
  for (const EliminationPlan::Row& row : plan.rows()) {
    const RowKind& kind = plan.kinds()[static_cast<std::size_t>(row.kind)];
    const std::int32_t* incident = plan.incidences().data() + row.incidences;
    for (std::size_t b = 1; b < kind.keptRoles.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        for (std::size_t lane = 0; lane < lanes; ++lane) {
          const int u = incident[a * lanes + lane];
          const int v = incident[b * lanes + lane];
          if (u < 0 || v < 0) continue;
          const std::pair<int, int> pair(std::max(u, v), std::min(u, v));
          if (pairs.empty() || pairs.back() != pair) pairs.push_back(pair);
        }
      }
    }
  }
  return pairs;
}

BlockPattern cliquePattern(const BlockLayout& layout, const PointNeighbours& neighbours,
                           const std::vector<std::pair<int, int>>& direct) {
  std::vector<std::int64_t> begin(static_cast<std::size_t>(layout.blocks()) + 2, 0);
  for (const std::int32_t kept : neighbours.kept) ++begin[static_cast<std::size_t>(kept) + 2];
  for (std::size_t i = 2; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<std::int32_t> points(neighbours.kept.size());
  for (int p = 0; p < neighbours.points(); ++p) {
    for (const std::int32_t kept : neighbours.of(p))
      points[static_cast<std::size_t>(begin[static_cast<std::size_t>(kept) + 1]++)] = p;
  }
  std::vector<std::pair<int, int>> pairs = direct;
  std::vector<int> seen(static_cast<std::size_t>(layout.blocks()), -1);
  for (int column = 0; column < layout.blocks(); ++column) {
    const auto first = static_cast<std::size_t>(begin[static_cast<std::size_t>(column)]);
    const auto last = static_cast<std::size_t>(begin[static_cast<std::size_t>(column) + 1]);
    for (std::size_t i = first; i < last; ++i) {
      const auto list = neighbours.of(points[i]);
      for (std::size_t at = list.size(); at-- > 0 && list[at] > column;) {
        if (seen[static_cast<std::size_t>(list[at])] == column) continue;
        seen[static_cast<std::size_t>(list[at])] = column;
        pairs.emplace_back(list[at], column);
      }
    }
  }
  return BlockPattern::fromPairs(layout, pairs);
}

}  // namespace quiver
