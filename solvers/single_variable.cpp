#include <quiver/solvers/single_variable.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <quiver/core/problem/panel_totals.h>
#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
/// Enough edges that a thread is worth waking for a few pieces.
constexpr int pieceEdges = 2048;
/// Nanoseconds, about, of linearising a row of an edge.
constexpr double linearizationPerRow = 4.0;

}  // namespace

bool SingleVariable::serves(const Problem& problem) { return problem.variables() == 1 && !problem.anyHeldDirections(); }

int SingleVariable::roleOf(int batch, int edge) const {
  const auto slots = problem_->batch(batch).slots(edge);
  const auto at = std::find(slots.begin(), slots.end(), problem_->slotOfVariable(0));
  return at == slots.end() ? -1 : static_cast<int>(at - slots.begin());
}

void SingleVariable::analyze(const Problem& problem, const Options&, int threads) {
  problem_ = &problem;
  dimension_ = problem.dimension(0);
  set_ = detectInstructionSet();
  double nanoseconds = 0.0;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    const EdgeShape& shape = shapes_.emplace_back(batch.largestShape());
    const bool lanewise = batch.rowBytes() > 0;
    nanoseconds += (lanewise ? linearizationPerRow : batch.rowCost().linearize) * batch.size() * shape.rows;
    Role role;
    if (batch.uniform()) {
      role.common = roleOf(b, 0);
      const int slot = problem.slotOfVariable(0);
      for (int i = 1; i < batch.size() && role.common >= 0; ++i) {
        if (batch.slots(i)[static_cast<std::size_t>(role.common)] != slot) role.common = -1;
      }
      role.sum = LaneProducts::sum(set_, shape.rows, dimension_);
    }
    roles_.push_back(role);
    const int piece = lanewise ? pieceEdges : Panel::capacity;
    for (int begin = 0; begin < batch.size(); begin += piece)
      pieces_.push_back({b, begin, std::min(batch.size(), begin + piece), {}});
  }
  threads_ = worthwhileThreads(threads, nanoseconds);
  workspaces_.resize(static_cast<std::size_t>(threads_));
  for (Workspace& work : workspaces_) {
    for (const EdgeShape& shape : shapes_) work.panels.emplace_back(shape);
    work.ids.resize(Panel::capacity);
  }
  const std::int64_t numbers = LaneProducts::squareSize(dimension_);
  sums_ = AlignedBuffer(numbers * lanes * static_cast<std::int64_t>(pieces_.size()), false);
  const auto size = static_cast<std::size_t>(dimension_);
  for (Equations* equations : {&current_, &trial_}) {
    equations->matrix.assign(size * size, 0.0);
    equations->gradient.assign(size, 0.0);
    equations->diagonal.assign(size, 0.0);
  }
  factor_.assign(size * size, 0.0);
  plan_ = {};
  plan_.eliminationReason = "there is one variable";
  plan_.linearSolver = "dense";
  plan_.linearSolverReason = fmt::format("one variable of {} scalars: summed and factored in place", dimension_);
  plan_.ordering = "natural";
  plan_.scalars = dimension_;
  plan_.factorNonzeros = dimension_ * (dimension_ + std::int64_t{1}) / 2;
  plan_.factorFlops = static_cast<double>(size * size * size) / 3.0;
  plan_.bytes = sums_.size() * 8;
}

CostTotals SingleVariable::linearize(const State& state) {
  if (tried_ == state.data()) {
    std::swap(current_, trial_);
  } else {
    compute(state, current_);
  }
  tried_ = nullptr;
  return current_.totals;
}

std::optional<CostTotals> SingleVariable::tryState(const State& trial) {
  compute(trial, trial_);
  tried_ = trial.data();
  return trial_.totals;
}

void SingleVariable::compute(const State& state, Equations& equations) {
  Stopwatch watch;
  const std::int64_t numbers = LaneProducts::squareSize(dimension_);
  std::fill_n(sums_.data(), sums_.size(), 0.0);
  parallelForWorkers(static_cast<std::int64_t>(pieces_.size()), threads_, threads_, [&](std::int64_t i, int worker) {
    sumPiece(state, pieces_[static_cast<std::size_t>(i)], sums_.data() + i * numbers * lanes,
             workspaces_[static_cast<std::size_t>(worker)]);
  });
  equations.totals = {};
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    equations.totals.add(pieces_[piece].totals);
    const double* const more = sums_.data() + static_cast<std::int64_t>(piece) * numbers * lanes;
    for (std::int64_t k = 0; piece > 0 && k < numbers * lanes; ++k) sums_[k] += more[k];
  }
  const auto total = [&](std::int64_t k) {
    const double* const lane = sums_.data() + k * lanes;
    return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
  };
  const auto size = static_cast<std::size_t>(dimension_);
  std::int64_t k = 0;
  for (std::size_t a = 0; a < size; ++a) {
    for (std::size_t b = a; b < size; ++b) equations.matrix[a * size + b] = equations.matrix[b * size + a] = total(k++);
    equations.diagonal[a] = equations.matrix[a * size + a];
  }
  for (double& entry : equations.gradient) entry = total(k++);
  seconds_.linearize += watch.lap();
}

void SingleVariable::sumPiece(const State& state, Piece& piece, double* sums, Workspace& work) const {
  const EdgeBatch& batch = problem_->batch(piece.batch);
  Panel panel = work.panels[static_cast<std::size_t>(piece.batch)].panel();
  panel.weighed = false;  // sums weigh
  const int step = batch.uniform() ? Panel::capacity : 1;
  PanelTotals totals(piece.batch);
  EdgeShape own;
  for (int first = piece.begin; first < piece.end; first += step) {
    const int count = std::min(step, piece.end - first);
    std::iota(work.ids.begin(), work.ids.begin() + count, first);
    batch.linearize(state, {work.ids.data(), static_cast<std::size_t>(count)}, panel);
    totals.add(first, count, panel.squaredError, panel.cost);
    if (!batch.uniform()) own = batch.shape(first);
    sumPanel(piece, first, count, batch.uniform() ? shapes_[static_cast<std::size_t>(piece.batch)] : own, panel, sums);
  }
  piece.totals = totals.sum();
}

void SingleVariable::sumPanel(const Piece& piece, int first, int count, const EdgeShape& shape, const Panel& panel,
                              double* sums) const {
  const Role& known = roles_[static_cast<std::size_t>(piece.batch)];
  const auto sum = known.sum ? known.sum : LaneProducts::sum(set_, shape.rows, dimension_);
  const int groups = (count + lanes - 1) / lanes;
  double weights[Panel::capacity];
  std::fill(weights + count, weights + groups * lanes, 0.0);  // lanes without an edge add nothing
  for (int role = 0; role < static_cast<int>(shape.columns.size()); ++role) {
    if (known.common >= 0 && role != known.common) continue;
    bool any = known.common >= 0;
    if (any) {
      std::copy_n(panel.weight, count, weights);
    } else {
      for (int i = 0; i < count; ++i) {
        const bool joins = roleOf(piece.batch, first + i) == role;
        weights[i] = joins ? panel.weight[i] : 0.0;
        any = any || joins;
      }
    }
    if (any) sum(panel.jacobian[role], panel.residual, weights, shape.rows, dimension_, groups, sums);
  }
}

bool SingleVariable::factorize(std::span<const double> damping, LinearOutcome& outcome) {
  const auto size = static_cast<std::size_t>(dimension_);
  factor_ = current_.matrix;
  for (std::size_t i = 0; i < damping.size(); ++i) factor_[i * size + i] += damping[i];
  for (std::size_t k = 0; k < size; ++k) {
    double pivot = factor_[k * size + k];
    for (std::size_t j = 0; j < k; ++j) pivot -= factor_[k * size + j] * factor_[k * size + j];
    if (!(pivot > 0.0) || !std::isfinite(pivot)) {
      outcome = {LinearOutcome::Kind::notPositiveDefinite, 0, static_cast<int>(k), pivot, 0};
      return factored_ = false;
    }
    const double reciprocal = factor_[k * size + k] = 1.0 / std::sqrt(pivot);
    for (std::size_t i = k + 1; i < size; ++i) {
      double value = factor_[i * size + k];
      for (std::size_t j = 0; j < k; ++j) value -= factor_[i * size + j] * factor_[k * size + j];
      factor_[i * size + k] = value * reciprocal;
    }
  }
  return factored_ = true;
}

void SingleVariable::substitute(std::span<double> b) const {
  const auto size = static_cast<std::size_t>(dimension_);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < i; ++j) b[i] -= factor_[i * size + j] * b[j];
    b[i] *= factor_[i * size + i];
  }
  for (std::size_t i = size; i-- > 0;) {
    for (std::size_t j = i + 1; j < size; ++j) b[i] -= factor_[j * size + i] * b[j];
    b[i] *= factor_[i * size + i];
  }
}

LinearOutcome SingleVariable::solve(std::span<const double> damping, std::span<double> delta,
                                    const StopCondition& stop) {
  LinearOutcome outcome;
  if (!factorize(damping, outcome)) return outcome;
  return solveWithLastFactor(delta, stop);
}

LinearOutcome SingleVariable::solveWithLastFactor(std::span<double> delta, const StopCondition&) {
  std::transform(current_.gradient.begin(), current_.gradient.end(), delta.begin(), std::negate<>());
  substitute(delta);
  return {};
}

bool SingleVariable::applyInverse(std::span<double> b) {
  if (factored_) substitute(b);
  return factored_;
}

void SingleVariable::multiply(std::span<const double> x, std::span<double> y) const {
  const auto size = static_cast<std::size_t>(dimension_);
  for (std::size_t i = 0; i < size; ++i) {
    y[i] = 0.0;
    for (std::size_t j = 0; j < size; ++j) y[i] += current_.matrix[i * size + j] * x[j];
  }
}

void SingleVariable::addSeconds(PhaseSeconds& seconds) {
  seconds.linearize += seconds_.linearize;
  seconds_ = {};
}

}  // namespace quiver
