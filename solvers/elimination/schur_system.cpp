#include <quiver/solvers/elimination/schur_system.h>

#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/util/stopwatch.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/backends/dense_solver.h>
#include <quiver/solvers/elimination/clique_pattern.h>

namespace quiver {
namespace {

/// Below this many scalars, and up to the second number if so many blocks are there, a dense factorisation is cheapest.
constexpr std::int64_t denseScalars = 300;
constexpr std::int64_t mostDenseScalars = 2000;
constexpr double denseFill = 0.4;

LinearOutcome::Kind kindOf(SolverStatus::Outcome outcome) {
  switch (outcome) {
    case SolverStatus::Outcome::success:
      return LinearOutcome::Kind::success;
    case SolverStatus::Outcome::notPositiveDefinite:
      return LinearOutcome::Kind::notPositiveDefinite;
    case SolverStatus::Outcome::notConverged:
      return LinearOutcome::Kind::notConverged;
    case SolverStatus::Outcome::interrupted:
      return LinearOutcome::Kind::interrupted;
    case SolverStatus::Outcome::memoryLimit:
      break;
  }
  return LinearOutcome::Kind::memoryLimit;
}

}  // namespace

SchurSystem::SchurSystem(std::unique_ptr<LinearSolver> solver, std::optional<EliminationChoice> choice)
    : solver_(std::move(solver)), choose_(solver_ == nullptr), choice_(std::move(choice)) {}

void SchurSystem::analyze(const Problem& problem, const Options& options, int threads) {
  problem_ = &problem;
  plan_ = {};
  surveyed_ = false;
  const EliminationChoice choice = choice_ ? *choice_ : chooseElimination(problem, options);
  plan_.eliminated = choice.count;
  plan_.eliminatedTypes = choice.types;
  plan_.eliminationReason = choice.reason;
  plan_.scalars = problem.scalars();
  elimination_ = EliminationPlan(problem, choice.eliminated);
  linearizer_ = RowLinearizer(problem, elimination_);
  assembler_ = PointAssembler(problem, elimination_, linearizer_, threads);
  eliminator_ = PointEliminator(problem, elimination_, linearizer_, assembler_, threads);
  gradient_.assign(static_cast<std::size_t>(problem.scalars()), 0.0);
  diagonal_.assign(static_cast<std::size_t>(problem.scalars()), 0.0);
  analyzeReduced(threads);
  plan_.bytes += elimination_.bytes() + assembler_.bytes() + eliminator_.bytes() + problem.scalars() * 16;
}

void SchurSystem::chooseSolver(const BlockPattern& pattern) {
  const std::int64_t scalars = pattern.layout().scalars();
  const double full = 0.5 * pattern.blocks() * (pattern.blocks() + 1.0);
  const double fill = static_cast<double>(pattern.entries()) / std::max(1.0, full);
  const bool dense = scalars <= denseScalars || (fill > denseFill && scalars <= mostDenseScalars);
  solver_ = dense ? makeDenseSolver() : makeBlockSolver();
  plan_.linearSolverReason = fmt::format("the reduced system has {} scalars and {:.2g} % of its blocks: {}", scalars,
                                         100.0 * fill, dense ? "dense is cheapest" : "sparse block Cholesky");
}

void SchurSystem::analyzeReduced(int threads) {
  if (elimination_.kept() == 0) {
    plan_.linearSolver = "none";
    plan_.linearSolverReason = "nothing is left after elimination";
    return;
  }
  const BlockPattern natural =
      cliquePattern(elimination_.keptLayout(), PointNeighbours(elimination_), directPairs(elimination_));
  if (choose_) {
    chooseSolver(natural);
  } else {
    plan_.linearSolverReason = "as asked";
  }
  BlockOrdering ordering = solver_->order(natural);
  order_ = std::move(ordering.order);
  position_.resize(order_.size());
  for (std::size_t block = 0; block < order_.size(); ++block)
    position_[static_cast<std::size_t>(order_[block])] = static_cast<int>(block);
  const auto pattern = std::make_shared<const BlockPattern>(natural.permuted(order_));
  matrix_ = BlockMatrix(pattern);
  solver_->analyze(pattern, threads);
  eliminator_.layOut(matrix_, position_, false);
  const auto scalars = static_cast<std::size_t>(elimination_.keptLayout().scalars());
  right_.assign(scalars, 0.0);
  blockVector_.assign(scalars, 0.0);
  const FactorStatistics statistics = solver_->statistics();
  plan_.linearSolver = solver_->name();
  plan_.ordering = ordering.name;
  plan_.factorNonzeros = statistics.nonzeros;
  plan_.factorFlops = statistics.flops;
  plan_.bytes = statistics.bytes + static_cast<std::int64_t>(matrix_.values().size()) * 8;
}

CostTotals SchurSystem::linearize(const State& state) {
  state_ = &state;
  const CostTotals totals = assembler_.linearize(state, seconds_);
  Stopwatch watch;
  assembler_.scatter(gradient_, diagonal_);
  if (!surveyed_) {
    eliminator_.factorize({});
    nameSingular();
    surveyed_ = true;
  }
  seconds_.assemble += watch.lap();
  return totals;
}

void SchurSystem::nameSingular() {
  plan_.singular.clear();
  for (const int variable : eliminator_.singularPoints())
    plan_.singular.push_back(problem_->vertex(problem_->slotOfVariable(variable)).id());
  std::sort(plan_.singular.begin(), plan_.singular.end());
}

LinearOutcome SchurSystem::solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) {
  Stopwatch watch;
  eliminator_.factorize(damping);
  seconds_.eliminate += watch.lap();
  if (elimination_.kept() > 0) {
    const LinearOutcome outcome = solveReduced(damping, delta, stop);
    if (!outcome.ok()) return outcome;
  }
  watch.lap();
  eliminator_.substitute(*state_, delta);
  seconds_.solve += watch.lap();
  return {};
}

LinearOutcome SchurSystem::solveReduced(std::span<const double> damping, std::span<double> delta,
                                        const StopCondition& stop) {
  Stopwatch watch;
  if (!eliminator_.reduce(*state_, damping, matrix_, right_, stop)) return {.kind = LinearOutcome::Kind::interrupted};
  seconds_.eliminate += watch.lap();
  SolverStatus status = solver_->factorize(matrix_, {}, stop);
  seconds_.factorize += watch.lap();
  if (!status.ok()) return outcomeOf(status);
  const BlockLayout& kept = elimination_.keptLayout();
  const BlockLayout& blocks = matrix_.layout();
  for (int block = 0; block < blocks.blocks(); ++block) {
    const double* from = right_.data() + kept.offset(order_[static_cast<std::size_t>(block)]);
    double* to = blockVector_.data() + blocks.offset(block);
    for (int c = 0; c < blocks.dimension(block); ++c) to[c] = -from[c];
  }
  status = solver_->solve(blockVector_);
  for (int block = 0; block < blocks.blocks(); ++block) {
    const int variable = elimination_.keptVariable(order_[static_cast<std::size_t>(block)]);
    std::copy_n(blockVector_.data() + blocks.offset(block), blocks.dimension(block),
                delta.data() + problem_->offset(variable));
  }
  seconds_.solve += watch.lap();
  return outcomeOf(status);
}

LinearOutcome SchurSystem::outcomeOf(const SolverStatus& status) const {
  LinearOutcome outcome;
  outcome.kind = kindOf(status.outcome);
  outcome.iterations = solver_->statistics().iterations;
  if (status.block >= 0) outcome.variable = elimination_.keptVariable(order_[static_cast<std::size_t>(status.block)]);
  outcome.coordinate = status.coordinate;
  outcome.pivot = status.pivot;
  return outcome;
}

void SchurSystem::multiply(std::span<const double> x, std::span<double> y) const {
  eliminator_.multiply(*state_, x, y);
}

void SchurSystem::addSeconds(PhaseSeconds& seconds) {
  seconds.linearize += seconds_.linearize;
  seconds.assemble += seconds_.assemble;
  seconds.eliminate += seconds_.eliminate;
  seconds.factorize += seconds_.factorize;
  seconds.solve += seconds_.solve;
  seconds_ = {};
}

}  // namespace quiver
