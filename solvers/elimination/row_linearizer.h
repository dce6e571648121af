#pragma once

#include <utility>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/problem/panel.h>
#include <quiver/solvers/elimination/elimination_plan.h>

namespace quiver {

/// Linearises rows of an elimination plan into panels in the first cache, from a copy of the edges in the order of rows
/// where their batch makes one. Lanes without an edge contribute nothing: their residual and blocks are zero. Const but
/// for refresh(); one workspace a task.
class RowLinearizer {
 public:
  /// Rows of one panel.
  static constexpr int mostRows = Panel::capacity / Panel::lanes;

  /// Panels by kind, and memory for one edge whose shape is its own.
  struct Workspace {
    std::vector<PanelBuffer> panels;
    std::vector<PanelBuffer> single;
    /// What rowPanel() linearised last; `end` = 0 forgets it.
    int begin = 0;
    int end = 0;
    const Panel* panel = nullptr;
  };

  RowLinearizer() = default;
  RowLinearizer(const Problem& problem, const EliminationPlan& plan, int threads);

  /// Copies edges again whose measurements, information or parameters have changed.
  void refresh();
  /// Bytes of the copies.
  std::int64_t bytes() const;
  static std::int64_t predictBytes(const Problem& problem, const EliminationPlan& plan);

  Workspace makeWorkspace() const;
  static std::int64_t workspaceBytes(const EliminationPlan& plan);

  /// The end of the run of rows that starts at `begin` and fits one panel.
  int runEnd(int begin, int end) const;
  /// Rows [begin, end) of one kind, at most mostRows. Adds their totals if `totals` is given.
  const Panel& linearize(const State& state, int begin, int end, Workspace& work, CostTotals* totals) const;
  /// The panel that holds a row, and its place there. Rows are taken in ascending order; they are linearised as many at
  /// a time as fit, before `limit`, whatever groups they belong to. A pass starts by setting the workspace's end to 0.
  std::pair<const Panel*, int> rowPanel(const State& state, int row, int limit, Workspace& work) const {
    if (row >= work.end) {
      work.begin = row;
      work.end = runEnd(row, limit);
      work.panel = &linearize(state, work.begin, work.end, work, nullptr);
    }
    return {work.panel, row - work.begin};
  }

 private:
  void pack(std::size_t kind);
  void linearizeSingly(const State& state, int begin, int end, const Panel& panel, Workspace& work) const;
  void clearLane(const RowKind& kind, const Panel& panel, int row, int lane) const;
  void dropHeldColumns(const RowKind& kind, const Panel& panel, int row, int lane, int edge) const;
  void findBadEdge(int begin, int end, const Panel& panel, CostTotals& totals) const;
  void addTotals(int begin, int end, const Panel& panel, CostTotals& totals) const;

  const Problem* problem_ = nullptr;
  const EliminationPlan* plan_ = nullptr;
  int threads_ = 1;
  /// Copies by kind, and the place of every row in its copy.
  std::vector<EdgeRows> copies_;
  std::vector<std::int32_t> places_;
};

}  // namespace quiver
