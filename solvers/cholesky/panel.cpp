#include <quiver/solvers/cholesky/panel.h>

#include <algorithm>
#include <utility>

#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

/// Rows that one task finishes.
constexpr int taskRows = 96;

}  // namespace

PanelFailure factorPanel(const KernelTable& kernels, const Panel& panel, int threads, const StopCondition& stop) {
  for (int begin = 0; begin < panel.columns; begin += chunkColumns) {
    if (begin > 0 && stop.reached()) return {.stopped = true};
    const int width = std::min(chunkColumns, panel.columns - begin);
    PanelFailure failure;
    failure.column = kernels.factorDiagonal(panel.values, panel.stride, begin, width, panel.inverse, &failure.pivot);
    if (failure.column >= 0) return {begin + failure.column, failure.pivot, false};
    const int below = begin + (width + 7) / 8 * 8;
    const int left = panel.rows - below;
    const int parts = threads <= 1 ? 1 : std::max(1, (left + taskRows - 1) / taskRows);
    const int partRows = parts == 1 ? left : taskRows;
    const auto rowsOf = [&](std::int64_t part) {
      const int first = below + static_cast<int>(part) * partRows;
      return std::pair{first, std::min(first + partRows, panel.rows)};
    };
    parallelFor(parts, threads, [&](std::int64_t part) {
      const auto [first, last] = rowsOf(part);
      kernels.solveRows(panel.values, panel.stride, begin, width, first, last, panel.inverse);
    });
    if (begin + width >= panel.columns) break;
    // The last rows have the most columns: they go first.
    parallelFor(parts, threads, [&](std::int64_t part) {
      const auto [first, last] = rowsOf(parts - 1 - part);
      kernels.updatePanel(panel.values, panel.stride, begin, width, begin + width, panel.columns, first, last);
    });
  }
  return {};
}

}  // namespace quiver::detail
