#include <quiver/solvers/normal_equations.h>

#include <algorithm>
#include <type_traits>

#include <fmt/format.h>

#include <quiver/core/algorithm/memory_estimate.h>
#include <quiver/core/algorithm/options.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/backends/dense_solver.h>
#include <quiver/solvers/linear_outcome.h>
#include <quiver/solvers/predicted_memory.h>

namespace quiver {
namespace {

/// Below this many unknown scalars a dense factorisation costs less than any bookkeeping.
constexpr std::int64_t denseScalars = 48;
/// What the assembly keeps for an edge: where its records and its blocks go.
constexpr std::int64_t edgeBytes = 48;

}  // namespace

NormalEquations::NormalEquations(std::unique_ptr<LinearSolver> solver) : solver_(std::move(solver)) {}
NormalEquations::NormalEquations() : choose_(true) {}

void NormalEquations::chooseSolver(const BlockPattern& pattern) {
  const std::int64_t scalars = pattern.layout().scalars();
  const double full = 0.5 * pattern.blocks() * (pattern.blocks() + 1.0);
  const double fill = static_cast<double>(pattern.entries()) / std::max(1.0, full);
  if (scalars <= denseScalars || (fill > 0.6 && scalars <= 2000)) {
    solver_ = makeDenseSolver();
    plan_.linearSolverReason =
        fmt::format("{} unknown scalars, {:.0f} % of the blocks present: dense is cheapest", scalars, 100.0 * fill);
  } else {
    solver_ = makeBlockSolver();
    plan_.linearSolverReason =
        fmt::format("{} unknown scalars, {:.2g} % of the blocks present: sparse block Cholesky", scalars, 100.0 * fill);
  }
}

void NormalEquations::analyze(const Problem& problem, const Options& options, int threads) {
  problem_ = &problem;
  plan_ = {};
  plan_.eliminationReason = "no vertices are eliminated beforehand";
  const BlockLayout layout(std::vector<int>(problem.dimensions().begin(), problem.dimensions().end()));
  const BlockPattern natural = BlockPattern::fromPairs(layout, AssemblyPlan::variablePairs(problem));
  if (choose_) {
    chooseSolver(natural);
  } else {
    plan_.linearSolverReason = solver_->name() == "power"
                                   ? "as asked, though nothing is eliminated: pcg needs far fewer products"
                                   : "as asked";
  }
  BlockOrdering ordering = solver_->order(natural);
  order_ = std::move(ordering.order);
  alike_ = problem.variables() > 0 ? problem.dimension(0) : 0;
  for (const int dimension : problem.dimensions()) alike_ = dimension == alike_ ? alike_ : 0;
  std::vector<int> position(order_.size());
  for (std::size_t block = 0; block < order_.size(); ++block)
    position[static_cast<std::size_t>(order_[block])] = static_cast<int>(block);
  const auto pattern = std::make_shared<const BlockPattern>(natural.permuted(order_));
  plan_.linearSolver = solver_->name();
  plan_.ordering = ordering.name;
  plan_.scalars = layout.scalars();
  const std::int64_t beside = 2 * matrixNumbers(*pattern) * 8 + problem.edges() * edgeBytes;
  if (options.memoryLimit > 0) {
    plan_.bytes = predictSolverBytes(*solver_, *pattern, threads) + beside;
    plan_.exceedsMemory = estimateCompilation(problem.graph(), options) + plan_.bytes > options.memoryLimit;
    if (plan_.exceedsMemory) return;
  }
  matrix_ = BlockMatrix(pattern);
  solver_->analyze(pattern, threads);
  assembler_ = Assembler(problem, matrix_, std::move(position), threads);

  const auto scalars = static_cast<std::size_t>(layout.scalars());
  gradient_.assign(scalars, 0.0);
  diagonal_.assign(scalars, 0.0);
  blockDamping_.assign(scalars, 0.0);
  blockVector_.assign(scalars, 0.0);
  blockResult_.assign(scalars, 0.0);
  const FactorStatistics statistics = solver_->statistics();
  plan_.factorNonzeros = statistics.nonzeros;
  plan_.factorFlops = statistics.flops;
  plan_.bytes = statistics.bytes + beside;
}

CostTotals NormalEquations::linearize(const State& state) {
  state_ = &state;
  const bool done = tried_ == state.data();
  tried_ = nullptr;
  return done ? triedTotals_ : assembler_.assemble(state, matrix_, gradient_, diagonal_, seconds_);
}

std::optional<CostTotals> NormalEquations::tryState(const State& trial) {
  triedTotals_ = assembler_.assemble(trial, matrix_, gradient_, diagonal_, seconds_);
  tried_ = trial.data();
  return triedTotals_;
}

void NormalEquations::dropTrial() {
  if (tried_ != nullptr) linearize(*state_);
}

LinearOutcome NormalEquations::solve(std::span<const double> damping, std::span<double> delta,
                                     const StopCondition& stop) {
  Stopwatch watch;
  std::span<const double> blockDamping;
  if (!damping.empty()) {
    toBlocks(damping, blockDamping_);
    blockDamping = blockDamping_;
  }
  loadGradient();
  const SolverStatus status = solver_->factorizeAndSolve(matrix_, blockDamping, blockVector_, stop);
  const LinearOutcome outcome = outcomeOf(status);
  if (outcome.hasStep()) toVariables(blockVector_, delta);
  const double solve = status.ok() ? solver_->solveSeconds() : 0.0;
  seconds_.factorize += watch.lap() - solve;
  seconds_.solve += solve;
  return outcome;
}

LinearOutcome NormalEquations::solveWithLastFactor(std::span<double> delta, const StopCondition&) {
  Stopwatch watch;
  loadGradient();
  const SolverStatus status = solver_->solve(blockVector_);
  toVariables(blockVector_, delta);
  seconds_.solve += watch.lap();
  return outcomeOf(status);
}

bool NormalEquations::applyInverse(std::span<double> b) {
  toBlocks(b, blockVector_);
  if (!solver_->solve(blockVector_).ok()) return false;
  toVariables(blockVector_, b);
  return true;
}

template <typename Copy>
void NormalEquations::forEachBlock(const Copy& copy) const {
  const auto alike = [&](const auto dimension) {
    for (std::size_t block = 0; block < order_.size(); ++block)
      copy(std::int64_t{order_[block]} * dimension, static_cast<std::int64_t>(block) * dimension, dimension);
  };
  switch (alike_) {
    case 3:
      return alike(std::integral_constant<int, 3>());
    case 6:
      return alike(std::integral_constant<int, 6>());
    default:
      for (std::size_t block = 0; block < order_.size(); ++block)
        copy(problem_->offset(order_[block]), matrix_.layout().offset(static_cast<int>(block)),
             problem_->dimension(order_[block]));
  }
}

void NormalEquations::loadGradient() {
  forEachBlock([&](std::int64_t from, std::int64_t to, const auto dimension) {
    for (int i = 0; i < dimension; ++i)
      blockVector_[static_cast<std::size_t>(to + i)] = -gradient_[static_cast<std::size_t>(from + i)];
  });
}

LinearOutcome NormalEquations::outcomeOf(const SolverStatus& status) const {
  LinearOutcome outcome = quiver::outcomeOf(status, *solver_);
  if (status.block >= 0) outcome.variable = order_[static_cast<std::size_t>(status.block)];
  return outcome;
}

void NormalEquations::multiply(std::span<const double> x, std::span<double> y) const {
  toBlocks(x, blockVector_);
  matrix_.multiply(blockVector_, blockResult_);
  toVariables(blockResult_, y);
}

void NormalEquations::toBlocks(std::span<const double> variables, std::span<double> blocks) const {
  forEachBlock([&](std::int64_t from, std::int64_t to, const auto dimension) {
    for (int i = 0; i < dimension; ++i)
      blocks[static_cast<std::size_t>(to + i)] = variables[static_cast<std::size_t>(from + i)];
  });
}

void NormalEquations::toVariables(std::span<const double> blocks, std::span<double> variables) const {
  forEachBlock([&](std::int64_t to, std::int64_t from, const auto dimension) {
    for (int i = 0; i < dimension; ++i)
      variables[static_cast<std::size_t>(to + i)] = blocks[static_cast<std::size_t>(from + i)];
  });
}

void NormalEquations::addSeconds(PhaseSeconds& seconds) {
  seconds.linearize += seconds_.linearize;
  seconds.assemble += seconds_.assemble;
  seconds.factorize += seconds_.factorize;
  seconds.solve += seconds_.solve;
  seconds_ = {};
}

}  // namespace quiver
