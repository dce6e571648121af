#include <quiver/solvers/cholesky/leaf_panels.h>

#include <algorithm>
#include <limits>

namespace quiver::detail {
namespace {

/// Scalar columns of a panel. With fewer, copying costs more than it saves; more leave the first-level cache.
constexpr int leastDepth = 12;
constexpr int mostDepth = 48;

int floor8(int value) { return value / 8 * 8; }
int ceil8(int value) { return (value + 7) / 8 * 8; }

/// Runs of consecutive rows, as far apart that their multiples of 8 do not meet. Returns the rows of the panel.
int addRuns(std::span<const std::int32_t> positions, int dimension, std::vector<RowRun>& runs) {
  const std::size_t first = runs.size();
  int rows = 0;
  for (const std::int32_t position : positions) {
    RowRun* last = runs.size() > first ? &runs.back() : nullptr;
    if (last != nullptr && floor8(position) <= ceil8(last->destination + last->length)) {
      last->length = position + dimension - last->destination;
    } else {
      runs.push_back({rows, dimension, position});
      last = &runs.back();
    }
    rows = last->source + ceil8(last->destination + last->length) - floor8(last->destination);
  }
  return rows;
}

}  // namespace

std::int64_t addLeafPanels(FactorPlan& plan, int node) {
  const int b = plan.leafDimension;
  if (b < leastPanelDimension) return 0;
  const int count = plan.nodes[node].lastBlock - plan.nodes[node].firstBlock;
  LeafColumn* const columns = plan.leafColumns.data() + plan.storage[node].leafColumns;
  const auto outsideOf = [&](int j) {
    return std::span(plan.leafPositions)
        .subspan(columns[j].rows + columns[j].inside, columns[j].below - columns[j].inside);
  };
  std::int64_t largest = 0;
  for (int first = 0; first < count;) {
    const std::span<const std::int32_t> outside = outsideOf(first);
    int end = first + 1;
    while (end < count && (end - first + 1) * b <= mostDepth && std::ranges::equal(outsideOf(end), outside)) ++end;
    const int depth = (end - first) * b;
    if (!outside.empty() && depth >= leastDepth) {
      const auto runs = static_cast<std::int32_t>(plan.panelRuns.size());
      const int rows = addRuns(outside, b, plan.panelRuns);
      const auto runCount = static_cast<std::int32_t>(plan.panelRuns.size()) - runs;
      plan.panels.push_back({first, end - 1, rows, runs, runCount});
      for (int j = first; j < end; ++j) columns[j].inPanel = 1;
      largest = std::max(largest, std::int64_t{rows} * depth);
    }
    first = end;
  }
  plan.panels.push_back({count, std::numeric_limits<std::int32_t>::max(), 0, 0, 0});
  return largest;
}

}  // namespace quiver::detail
