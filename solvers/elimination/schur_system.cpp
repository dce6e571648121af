#include <quiver/solvers/elimination/schur_system.h>

#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/algorithm/memory_estimate.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/backends/dense_solver.h>
#include <quiver/solvers/backends/pcg_solver.h>
#include <quiver/solvers/block/factor_pattern.h>
#include <quiver/solvers/linear_outcome.h>
#include <quiver/solvers/predicted_memory.h>

namespace quiver {
namespace {

/// Below this many scalars, and up to the second number if so many blocks are there, a dense factorisation is cheapest.
constexpr std::int64_t denseScalars = 300;
constexpr std::int64_t mostDenseScalars = 2000;
constexpr double denseFill = 0.4;
/// Operations a second of a sparse factorisation, seconds of a product with S for one of its blocks and, without S, for
/// a row of eight edges: on a 2020s x86 core. They rank alternatives.
constexpr double factorRate = 35e9;
constexpr double secondsPerBlock = 4e-8;
constexpr double secondsPerRow = 2.5e-7;
/// Products that conjugate gradients take for a step as good as an exact one.
constexpr double expectedIterations = 150.0;
/// Exactness of such a step, if the system chose conjugate gradients itself.
constexpr double stepTolerance = 1e-3;

/// Whether products through the edges beat those with S: where S has more blocks than there are rows of edges to
/// linearise anew for each.
bool prefersProducts(const BlockPattern& pattern, const EliminationPlan& plan) {
  return static_cast<double>(pattern.entries()) * secondsPerBlock >
         static_cast<double>(plan.rows().size()) * secondsPerRow;
}

int mostKeptOfAnEdge(const Problem& problem, const EliminationPlan& plan) {
  int most = 1;
  for (int b = 0; b < problem.batches(); ++b) {
    for (int edge = 0; edge < problem.batch(b).size(); ++edge) {
      const auto slots = problem.batch(b).slots(edge);
      most = std::max(most, static_cast<int>(std::ranges::count_if(slots, [&](int slot) {
                        const int variable = problem.variableOfSlot(slot);
                        return variable >= 0 && plan.keptOf(variable) >= 0;
                      })));
    }
  }
  return most;
}

}  // namespace

SchurSystem::SchurSystem(std::unique_ptr<LinearSolver> solver, std::optional<EliminationChoice> choice)
    : solver_(std::move(solver)), choose_(solver_ == nullptr), choice_(std::move(choice)) {}

void SchurSystem::analyze(const Problem& problem, const Options& options, int threads) {
  problem_ = &problem;
  plan_ = {};
  surveyed_ = false;
  tried_ = nullptr;
  const EliminationChoice choice = choice_ ? *choice_ : chooseElimination(problem, options);
  plan_.eliminated = choice.count;
  plan_.eliminatedTypes = choice.types;
  plan_.eliminationReason = choice.reason;
  plan_.scalars = problem.scalars();
  elimination_ = EliminationPlan(problem, choice.eliminated);
  planReduced(options);
  if (options.memoryLimit > 0) {
    plan_.bytes = predictBytes(threads);
    plan_.exceedsMemory = estimateCompilation(problem.graph(), options) + plan_.bytes > options.memoryLimit;
    if (plan_.exceedsMemory) return;
  }
  layOut(threads);
}

/// Pattern, solver and order of what is left.
void SchurSystem::planReduced(const Options& options) {
  if (elimination_.kept() == 0) {
    plan_.linearSolver = "none";
    plan_.linearSolverReason = "nothing is left after elimination";
    return;
  }
  neighbours_ = PointNeighbours(elimination_);
  const auto direct = directPairs(elimination_);
  BlockPattern natural = cliquePattern(elimination_.keptLayout(), neighbours_, direct);
  plan_.linearSolverReason = "as asked";
  if (choose_) chooseSolver(natural, options);
  sums_ = solver_->name() == "power";
  implicit_ = sums_ || (solver_->name() == "pcg" && prefersProducts(natural, elimination_));
  if (implicit_) {
    // Of S the diagonal blocks alone, for the preconditioner.
    natural = BlockPattern::fromPairs(elimination_.keptLayout(), {});
    conjugate_ = ConjugateReduction({options.linearTolerance, options.maxLinearIterations});
    PowerSeries::Limits limits{.tolerance = options.linearTolerance, .terms = options.maxLinearIterations};
    if (options.maxLinearIterations == 0) {
      // Few terms reach a small residual; a looser one than usual may be asked for.
      limits = {};
      limits.tolerance = std::max(limits.tolerance, options.linearTolerance);
    }
    limits.divisor = mostKeptOfAnEdge(*problem_, elimination_);
    series_ = PowerSeries(limits);
    solver_ = makeBlockSolver();
  }
  BlockOrdering ordering = solver_->order(natural);
  order_ = std::move(ordering.order);
  position_.resize(order_.size());
  for (std::size_t block = 0; block < order_.size(); ++block)
    position_[static_cast<std::size_t>(order_[block])] = static_cast<int>(block);
  pattern_ = std::make_shared<const BlockPattern>(natural.permuted(order_));
  plan_.linearSolver = sums_ ? "power" : implicit_ ? "pcg, implicit" : solver_->name();
  plan_.ordering = ordering.name;
}

/// Dense, sparse or iterative, by predicted operations.
void SchurSystem::chooseSolver(const BlockPattern& pattern, const Options& options) {
  const std::int64_t scalars = pattern.layout().scalars();
  const double full = 0.5 * pattern.blocks() * (pattern.blocks() + 1.0);
  const double fill = static_cast<double>(pattern.entries()) / std::max(1.0, full);
  const std::string what =
      fmt::format("the reduced system has {} scalars and {:.2g} % of its blocks", scalars, 100.0 * fill);
  if (scalars <= denseScalars || (fill > denseFill && scalars <= mostDenseScalars)) {
    solver_ = makeDenseSolver();
    plan_.linearSolverReason = what + ": dense is cheapest";
    return;
  }
  solver_ = makeBlockSolver();
  const FactorSize size = predictFactor(pattern, solver_->order(pattern).order);
  const double direct = size.flops / factorRate;
  const double product = std::min(static_cast<double>(pattern.entries()) * secondsPerBlock,
                                  static_cast<double>(elimination_.rows().size()) * secondsPerRow);
  const double iterative = expectedIterations * product;
  if (direct > iterative) {
    solver_ = makePcgSolver({stepTolerance, options.maxLinearIterations, false});
    plan_.linearSolverReason = fmt::format("{}: a factorisation would take {:.3g} operations", what, size.flops);
  } else {
    plan_.linearSolverReason = what + ": sparse block Cholesky";
  }
}

std::int64_t SchurSystem::predictBytes(int threads) const {
  std::int64_t bytes =
      elimination_.bytes() + RowLinearizer::predictBytes(*problem_, elimination_) + 2 * elimination_.sumNumbers() * 8;
  if (elimination_.kept() == 0) return bytes;
  bytes += static_cast<std::int64_t>(neighbours_.kept.size()) * 2;  // places
  if (!implicit_) {
    std::int64_t pairs = 0;
    for (int p = 0; p < neighbours_.points(); ++p) {
      const auto k = static_cast<std::int64_t>(neighbours_.of(p).size());
      pairs += k * (k + 1) / 2;
    }
    bytes += pairs * 5;  // the pairs, and the blocks they share
  }
  const std::int64_t values = matrixNumbers(*pattern_);
  return bytes + values * 8 * PointEliminator::copies(values) + pattern_->entries() * 20 +
         predictSolverBytes(*solver_, *pattern_, threads);
}

void SchurSystem::layOut(int threads) {
  linearizer_ = RowLinearizer(*problem_, elimination_, threads);
  assembler_ = PointAssembler(*problem_, elimination_, linearizer_, threads);
  eliminator_ = PointEliminator(*problem_, elimination_, linearizer_, assembler_, threads);
  gradient_.assign(static_cast<std::size_t>(problem_->scalars()), 0.0);
  diagonal_.assign(static_cast<std::size_t>(problem_->scalars()), 0.0);
  plan_.bytes = elimination_.bytes() + problem_->scalars() * 16;
  if (elimination_.kept() > 0) {
    neighbours_ = {};
    matrix_ = BlockMatrix(pattern_);
    solver_->analyze(pattern_, threads);
    eliminator_.layOut(matrix_, position_, implicit_);
    const auto scalars = static_cast<std::size_t>(elimination_.keptLayout().scalars());
    right_.assign(scalars, 0.0);
    blockVector_.assign(scalars, 0.0);
    const FactorStatistics statistics = solver_->statistics();
    plan_.factorNonzeros = statistics.nonzeros;
    plan_.factorFlops = statistics.flops;
    plan_.bytes += statistics.bytes + static_cast<std::int64_t>(matrix_.values().size()) * 8;
  }
  plan_.bytes += linearizer_.bytes() + assembler_.bytes() + eliminator_.bytes();
}

void SchurSystem::restart() {
  conjugate_.restart();
  if (solver_) solver_->restart();
}

CostTotals SchurSystem::linearize(const State& state) {
  state_ = &state;
  CostTotals totals;
  if (tried_ != nullptr && tried_ == state.data()) {
    assembler_.takeTrial();
    totals = triedTotals_;
  } else {
    linearizer_.refresh();
    totals = assembler_.linearize(state, seconds_);
  }
  tried_ = nullptr;
  Stopwatch watch;
  assembler_.scatter(gradient_, diagonal_);
  if (!surveyed_) {
    nameSingular();
    surveyed_ = true;
  }
  seconds_.assemble += watch.lap();
  return totals;
}

std::optional<CostTotals> SchurSystem::tryState(const State& trial) {
  triedTotals_ = assembler_.linearizeTrial(trial, seconds_);
  tried_ = trial.data();
  return triedTotals_;
}

void SchurSystem::nameSingular() {
  plan_.singular.clear();
  for (const int variable : eliminator_.singularPoints())
    plan_.singular.push_back(problem_->vertex(problem_->slotOfVariable(variable)).id());
  std::sort(plan_.singular.begin(), plan_.singular.end());
}

LinearOutcome SchurSystem::solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) {
  Stopwatch watch;
  eliminator_.setDamping(damping);
  seconds_.eliminate += watch.lap();
  LinearOutcome outcome;
  if (elimination_.kept() > 0) {
    outcome = solveReduced(delta, stop);
    if (!outcome.hasStep()) return outcome;
  }
  watch.lap();
  eliminator_.substitute(*state_, delta);
  seconds_.solve += watch.lap();
  return outcome;
}

LinearOutcome SchurSystem::solveReduced(std::span<double> delta, const StopCondition& stop) {
  Stopwatch watch;
  if (!eliminator_.reduce(*state_, matrix_, right_, stop)) return {.kind = LinearOutcome::Kind::interrupted};
  if (sums_) eliminator_.startMatrix(matrix_);
  seconds_.eliminate += watch.lap();
  SolverStatus status = solver_->factorize(matrix_, {}, stop);
  seconds_.factorize += watch.lap();
  if (!status.ok()) return outcomeOf(status);
  LinearOutcome outcome;
  if (implicit_) {
    const auto precondition = [&](std::span<double> x) { return applyFactor(x); };
    const auto multiply = [&](std::span<const double> x, std::span<double> y) {
      eliminator_.multiplyReduced(*state_, x, y);
    };
    outcome = sums_ ? series_.solve(right_, precondition, multiply, stop)
                    : conjugate_.solve(right_, precondition, multiply, stop);
  } else {
    status = applyFactor(right_);
    outcome = outcomeOf(status);
  }
  for (int kept = 0; kept < elimination_.kept(); ++kept) {
    const double* from = right_.data() + elimination_.keptLayout().offset(kept);
    double* to = delta.data() + problem_->offset(elimination_.keptVariable(kept));
    for (int c = 0; c < elimination_.keptLayout().dimension(kept); ++c) to[c] = -from[c];
  }
  seconds_.solve += watch.lap();
  return outcome;
}

/// x ← M⁻¹ x over the kept vertices, M what was factored.
SolverStatus SchurSystem::applyFactor(std::span<double> x) {
  const BlockLayout& kept = elimination_.keptLayout();
  const BlockLayout& blocks = matrix_.layout();
  const auto copy = [&](bool back) {
    for (int block = 0; block < blocks.blocks(); ++block) {
      double* own = x.data() + kept.offset(order_[static_cast<std::size_t>(block)]);
      double* permuted = blockVector_.data() + blocks.offset(block);
      const int n = blocks.dimension(block);
      back ? std::copy_n(permuted, n, own) : std::copy_n(own, n, permuted);
    }
  };
  copy(false);
  const SolverStatus status = solver_->solve(blockVector_);
  copy(true);
  return status;
}

LinearOutcome SchurSystem::outcomeOf(const SolverStatus& status) const {
  LinearOutcome outcome = quiver::outcomeOf(status, *solver_);
  if (status.block >= 0) outcome.variable = elimination_.keptVariable(order_[static_cast<std::size_t>(status.block)]);
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
