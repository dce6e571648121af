#include <quiver/solvers/elimination/row_linearizer.h>

#include <algorithm>
#include <cmath>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;

}  // namespace

RowLinearizer::RowLinearizer(const Problem& problem, const EliminationPlan& plan, int threads)
    : problem_(&problem), plan_(&plan), threads_(threads), copies_(plan.kinds().size()) {
  std::vector<std::int32_t> next(plan.kinds().size(), 0);
  places_.reserve(plan.rows().size());
  for (const EliminationPlan::Row& row : plan.rows()) places_.push_back(next[static_cast<std::size_t>(row.kind)]++);
  refresh();
}

void RowLinearizer::refresh() {
  for (std::size_t kind = 0; kind < copies_.size(); ++kind) {
    const EdgeBatch& batch = problem_->batch(plan_->kinds()[kind].batch);
    if (batch.uniform() && batch.rowBytes() > 0 && copies_[kind].revision != batch.revision()) pack(kind);
  }
}

void RowLinearizer::pack(std::size_t kind) {
  std::vector<std::int32_t> edges;
  for (std::size_t row = 0; row < places_.size(); ++row) {
    if (plan_->rows()[row].kind != static_cast<std::int32_t>(kind)) continue;
    const std::int32_t* own = plan_->edges(static_cast<std::int64_t>(row));
    edges.insert(edges.end(), own, own + lanes);
  }
  problem_->batch(plan_->kinds()[kind].batch).packRows(edges, copies_[kind], threads_);
}

std::int64_t RowLinearizer::bytes() const {
  std::int64_t bytes = static_cast<std::int64_t>(places_.size()) * 4;
  for (const EdgeRows& copy : copies_) bytes += copy.bytes();
  return bytes;
}

std::int64_t RowLinearizer::predictBytes(const Problem& problem, const EliminationPlan& plan) {
  std::int64_t bytes = 0;
  for (const EliminationPlan::Row& row : plan.rows())
    bytes += 4 + problem.batch(plan.kinds()[static_cast<std::size_t>(row.kind)].batch).rowBytes();
  return bytes;
}

RowLinearizer::Workspace RowLinearizer::makeWorkspace() const {
  Workspace work;
  for (const RowKind& kind : plan_->kinds()) {
    work.panels.emplace_back(kind.shape);
    work.single.emplace_back(problem_->batch(kind.batch).uniform() ? EdgeShape{} : kind.shape);
  }
  return work;
}

std::int64_t RowLinearizer::workspaceBytes(const EliminationPlan& plan) {
  std::int64_t bytes = 0;
  for (const RowKind& kind : plan.kinds()) {
    std::int64_t numbers = kind.shape.rows + 3;
    for (const int columns : kind.shape.columns) numbers += std::int64_t{columns} * kind.shape.rows;
    bytes += numbers * Panel::capacity * 8;
  }
  return bytes;
}

int RowLinearizer::runEnd(int begin, int end) const {
  const auto& rows = plan_->rows();
  const std::int32_t kind = rows[static_cast<std::size_t>(begin)].kind;
  int last = begin + 1;
  while (last < end && last < begin + mostRows && rows[static_cast<std::size_t>(last)].kind == kind) ++last;
  return last;
}

const Panel& RowLinearizer::linearize(const State& state, int begin, int end, Workspace& work,
                                      CostTotals* totals) const {
  const auto kindIndex = static_cast<std::size_t>(plan_->rows()[static_cast<std::size_t>(begin)].kind);
  const RowKind& kind = plan_->kinds()[kindIndex];
  const EdgeBatch& batch = problem_->batch(kind.batch);
  const Panel& panel = work.panels[kindIndex].panel();
  if (batch.uniform()) {
    const std::span<const std::int32_t> edges(plan_->edges(begin), static_cast<std::size_t>((end - begin) * lanes));
    const EdgeRows& copy = copies_[kindIndex];
    if (copy.empty()) {
      batch.linearize(state, edges, panel);
    } else {
      batch.linearizeRows(state, copy, places_[static_cast<std::size_t>(begin)], edges, panel);
    }
  } else {
    linearizeSingly(state, begin, end, panel, work);
  }
  if (totals != nullptr) addTotals(begin, end, panel, *totals);
  for (int row = begin; row < end; ++row) {
    const std::uint32_t present = plan_->rows()[static_cast<std::size_t>(row)].lanes;
    if (present == 0xff && !problem_->anyHeldDirections()) continue;
    for (int lane = 0; lane < lanes; ++lane) {
      if ((present >> lane & 1) == 0) {
        clearLane(kind, panel, row - begin, lane);
      } else if (problem_->anyHeldDirections()) {
        dropHeldColumns(kind, panel, row - begin, lane, plan_->edges(row)[lane]);
      }
    }
  }
  return panel;
}

void RowLinearizer::linearizeSingly(const State& state, int begin, int end, const Panel& panel, Workspace& work) const {
  const auto kindIndex = static_cast<std::size_t>(plan_->rows()[static_cast<std::size_t>(begin)].kind);
  const RowKind& kind = plan_->kinds()[kindIndex];
  const Panel& single = work.single[kindIndex].panel();
  const int rows = kind.shape.rows;
  for (int i = 0; i < (end - begin) * lanes; ++i) {
    const std::int32_t edge = plan_->edges(begin)[i];
    problem_->batch(kind.batch).linearize(state, {&edge, 1}, single);
    const int group = i / lanes;
    const int lane = i % lanes;
    panel.squaredError[i] = single.squaredError[0];
    panel.cost[i] = single.cost[0];
    for (int r = 0; r < rows; ++r) panel.residual[(group * rows + r) * lanes + lane] = single.residual[r * lanes];
    for (std::size_t role = 0; role < kind.shape.columns.size(); ++role) {
      const int numbers = rows * kind.shape.columns[role];
      double* out = panel.jacobian[role] + group * numbers * lanes + lane;
      for (int k = 0; k < numbers; ++k) out[k * lanes] = single.jacobian[role][k * lanes];
    }
  }
}

void RowLinearizer::clearLane(const RowKind& kind, const Panel& panel, int row, int lane) const {
  const int rows = kind.shape.rows;
  for (int r = 0; r < rows; ++r) panel.residual[(row * rows + r) * lanes + lane] = 0.0;
  for (std::size_t role = 0; role < kind.shape.columns.size(); ++role) {
    const int numbers = rows * kind.shape.columns[role];
    double* block = panel.jacobian[role] + row * numbers * lanes + lane;
    for (int k = 0; k < numbers; ++k) block[k * lanes] = 0.0;
  }
}

void RowLinearizer::dropHeldColumns(const RowKind& kind, const Panel& panel, int row, int lane, int edge) const {
  const auto slots = problem_->batch(kind.batch).slots(edge);
  for (std::size_t role = 0; role < slots.size(); ++role) {
    const int variable = problem_->variableOfSlot(slots[role]);
    const std::uint64_t held = variable < 0 ? 0 : problem_->heldDirections(variable);
    const int columns = kind.shape.columns[role];
    for (int c = 0; held != 0 && c < columns && c < 64; ++c) {
      if ((held >> c & 1) == 0) continue;
      for (int r = 0; r < kind.shape.rows; ++r)
        panel.jacobian[role][((row * columns + c) * kind.shape.rows + r) * lanes + lane] = 0.0;
    }
  }
}

void RowLinearizer::addTotals(int begin, int end, const Panel& panel, CostTotals& totals) const {
  const auto& rows = plan_->rows();
  double chi2[lanes] = {};
  double cost[lanes] = {};
  for (int row = begin; row < end; ++row) {
    const std::uint32_t present = rows[static_cast<std::size_t>(row)].lanes;
    const double* const squares = panel.squaredError + (row - begin) * lanes;
    const double* const costs = panel.cost + (row - begin) * lanes;
    for (int lane = 0; lane < lanes; ++lane) {
      const bool counts = present == 0xff || (present >> lane & 1) != 0;
      chi2[lane] += counts ? squares[lane] : 0.0;
      cost[lane] += counts ? costs[lane] : 0.0;
    }
  }
  CostTotals sum;
  for (int lane = 0; lane < lanes; ++lane) {
    sum.chi2 += chi2[lane];
    sum.cost += cost[lane];
  }
  totals.chi2 += sum.chi2;
  totals.cost += sum.cost;
  if (!(std::isfinite(sum.chi2) && std::isfinite(sum.cost)) && totals.badBatch < 0)
    findBadEdge(begin, end, panel, totals);
}

void RowLinearizer::findBadEdge(int begin, int end, const Panel& panel, CostTotals& totals) const {
  const auto& rows = plan_->rows();
  for (int row = begin; row < end; ++row) {
    for (int lane = 0; lane < lanes; ++lane) {
      if ((rows[static_cast<std::size_t>(row)].lanes >> lane & 1) == 0) continue;
      const int at = (row - begin) * lanes + lane;
      if (std::isfinite(panel.squaredError[at]) && std::isfinite(panel.cost[at])) continue;
      totals.badBatch = plan_->kinds()[static_cast<std::size_t>(rows[static_cast<std::size_t>(row)].kind)].batch;
      totals.badEdge = plan_->edges(row)[lane];
      return;
    }
  }
}

}  // namespace quiver
