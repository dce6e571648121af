#include <quiver/core/algorithm/optimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/ranges.h>

#include <quiver/core/algorithm/algorithms.h>
#include <quiver/core/algorithm/descent.h>
#include <quiver/core/algorithm/gauge_policy.h>
#include <quiver/core/algorithm/graph_watch.h>
#include <quiver/core/algorithm/hold_check.h>
#include <quiver/core/algorithm/memory_estimate.h>
#include <quiver/core/algorithm/structure_key.h>
#include <quiver/core/graph/estimates.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/free_memory.h>
#include <quiver/core/util/parallel.h>

namespace quiver {
namespace {

/// nullptr for "auto".
const NamedEntry<Algorithm>* algorithmOf(const Options& options, const Registry& registry) {
  if (options.algorithm == "auto") return nullptr;
  if (const NamedEntry<Algorithm>* known = findAlgorithm(registry, options.algorithm)) return known;
  throw GraphError(
      fmt::format("no algorithm '{}'; there are {}", options.algorithm, fmt::join(algorithmNames(registry), ", ")));
}

/// Edges above which what compiling and analysing leave behind is worth returning to the system.
constexpr std::int64_t largeProblem = 200000;

std::unique_ptr<LinearSystem> makeSystem(const Registry& registry, const Options& options) {
  if (const LinearSystemFactory* factory = registry.findLinearSystem(options.linearSolver)) {
    if (std::unique_ptr<LinearSystem> system = (*factory)(options)) return system;
    throw GraphError(fmt::format("the factory of the linear solver '{}' made none", options.linearSolver));
  }
  std::string known;
  for (const auto& entry : registry.linearSystems()) known += (known.empty() ? "" : ", ") + entry.name;
  throw GraphError(
      fmt::format("no linear solver '{}'; the registry has {}", options.linearSolver, known.empty() ? "none" : known));
}

int threadsOf(const Options& options) { return options.threads > 0 ? options.threads : hardwareThreads(); }

void announce(const Options& options, const Graph& graph, std::string_view phase) {
  if (!options.phase) return;
  const GraphWatch watch(graph);
  options.phase(phase);
  watch.require("function told of phases");
}

/// Ends before the first linearisation. The cost is not a number if it is not to be had before the stop.
void reportUnmoved(Problem* problem, Status status, std::string_view reason, Summary& summary) {
  CostTotals totals;
  totals.chi2 = totals.cost = std::numeric_limits<double>::quiet_NaN();
  try {
    if (problem != nullptr) totals = problem->evaluate(problem->state());
  } catch (const WorkStopped&) {
  }
  summary.initialChi2 = summary.finalChi2 = totals.chi2;
  summary.initialCost = summary.finalCost = totals.cost;
  summary.status = status;
  summary.reason = reason;
}

void reportStopped(Problem& problem, const StopCondition& stop, Summary& summary) {
  if (stop.reason() == StopCondition::Reason::timeLimit) {
    reportUnmoved(&problem, Status::timeLimit, "the time limit is reached before the first step", summary);
  } else {
    reportUnmoved(&problem, Status::interrupted, "interrupted before the first step", summary);
  }
}

/// Lets costly edges of a problem look at a stop condition as long as it lives.
class StopGuard {
 public:
  StopGuard(Problem& problem, const StopCondition& stop) : problem_(problem) { problem.setStop(&stop); }
  StopGuard(const StopGuard&) = delete;
  StopGuard& operator=(const StopGuard&) = delete;
  ~StopGuard() { problem_.setStop(nullptr); }

 private:
  Problem& problem_;
};

std::string describeExcess(std::int64_t bytes, const Options& options) {
  return fmt::format("the solve would take at least {} bytes beside the graph, {} are allowed", bytes,
                     options.memoryLimit);
}

bool hasRobustKernel(const Problem& problem) {
  for (int b = 0; b < problem.batches(); ++b) {
    if (problem.batch(b).robust()) return true;
  }
  return false;
}

/// What is run and why; true if "auto" begins with damped steps. Full steps need neither a damped gauge nor the damping
/// that keeps eliminated landmarks in place; with robust kernels they leave the basin of the start, where outliers look
/// like any other minimum.
bool chooseAlgorithm(const NamedEntry<Algorithm>* asked, bool robust, const GaugeReport& gauge, SolvePlan& plan) {
  if (asked) {
    plan.algorithm = asked->name;
    plan.algorithmReason = "as asked";
    return false;
  }
  const bool damped = plan.eliminated > 0 || gauge.free > 0 || robust;
  plan.algorithm = damped ? "lm" : "gn";
  plan.algorithmReason = plan.eliminated > 0 ? "vertices are eliminated"
                         : robust            ? "edges have robust kernels"
                         : gauge.free > 0    ? "the gauge is free"
                                             : "full steps while they make progress";
  return damped;
}

void descend(Descent& descent, const NamedEntry<Algorithm>* asked, bool damped, SolvePlan& plan) try {
  if (descent.begin()) {
    if (asked) {
      asked->value.run(descent);
    } else if (damped) {
      levenbergMarquardt(descent);
    } else if (!gaussNewton(descent, true)) {
      plan.algorithm = "gn, then lm";
      plan.algorithmReason = "a full step failed, so steps are damped from there";
      levenbergMarquardt(descent);
    }
    if (!descent.ended()) descent.finish(Status::stalled, "the algorithm returned without saying why");
  }
  descent.end();
} catch (const WorkStopped&) {
  descent.stopMidway();
  descent.end();
}

}  // namespace

/// What one call leaves for the next.
struct Optimizer::Compiled {
  /// Keeps the code of the types loaded as long as what was compiled from them lives.
  std::shared_ptr<const Registry> registry;
  StructureKey key;
  /// The graph's when the key was made.
  std::uint64_t revision = 0;
  std::unique_ptr<Problem> problem;
  std::unique_ptr<LinearSystem> system;
  /// Asked whether it eliminates, not analysed yet.
  std::unique_ptr<LinearSystem> asked;
  GaugeReport gauge;
  std::vector<HeldSlot> held;
  HoldCheck holds;
  DescentMemory memory;
  Summary summary;
  /// Whether the automatic policy goes by damped steps.
  bool damped = false;
  bool settled = false;
  /// Numbers that the gauge was found by have changed, estimates aside.
  bool changed = false;
  bool reused = false;
  /// The gauge is that of an earlier call, whose estimates were others.
  bool gaugeKept = false;

  /// The problem, anew unless the graph has the structure of the last call.
  void compile(Graph& graph, const Options& options, bool again) {
    const int threads = threadsOf(options);
    StructureKey newKey;
    if (again) {
      const std::uint64_t before = std::exchange(revision, graph.revision());
      const bool unchanged = key.isOf(graph) && revision == before;
      newKey = StructureKey(graph, options, threads, unchanged ? &key : nullptr);
      if (problem && newKey == key) {
        changed = changed || !unchanged;
        return problem->refresh(unchanged);
      }
    }
    system.reset();
    asked.reset();
    problem.reset();
    gauge = {};
    held.clear();
    holds = {};
    memory.scale.reset();
    settled = changed = false;
    key = {};  // should compiling fail, nothing is known
    registry = graph.registry();
    announce(options, graph, "compiling the problem");
    problem = std::make_unique<Problem>(graph, ProblemScope{options.level, options.free, threads});
    key = std::move(newKey);
  }

  /// The gauge of a problem just compiled, or whose numbers have changed; false if that was stopped.
  bool settle(const Options& options, const NamedEntry<Algorithm>* algorithm) {
    reused = settled;
    gaugeKept = settled && !changed;
    if (gaugeKept || (problem->variables() == 0 && held.empty())) return settled = true;
    if (!settled) {
      // Eliminating or robust kernels make the algorithm a damped one, which leaves the gauge free.
      asked = makeSystem(*problem->graph().registry(), options);
      damped = algorithm ? algorithm->value.damped : hasRobustKernel(*problem) || asked->eliminates(*problem, options);
    } else if (!held.empty()) {
      problem->releaseDirections();
    }
    try {
      gauge = {};
      std::vector<HeldSlot> found = settleGauge(*problem, options, damped, gauge);
      if (settled && found != held) {
        // Other variables: what was analysed serves no more.
        reused = false;
        system.reset();
        memory.scale.reset();
      }
      held = std::move(found);
      holds = HoldCheck(*problem, held);
      settled = true;
      changed = false;
    } catch (const WorkStopped&) {
      gauge = {};
      settled = false;
      key = {};
    }
    return settled;
  }

  /// Whether the descent ended as one does whose gauge is not the one that was found at other estimates.
  bool doubtsGauge() const {
    return gaugeKept && (summary.status == Status::numericalFailure || summary.plan.algorithm == "gn, then lm");
  }

  /// The linear system of a problem whose gauge is settled, ready for numbers.
  void analyze(const Options& options, int threads) {
    if (system) return system->restart();
    announce(options, problem->graph(), "analysing the structure");
    std::unique_ptr<LinearSystem> made = asked ? std::move(asked) : makeSystem(*problem->graph().registry(), options);
    made->analyze(*problem, options, threads);
    system = std::move(made);
    if (problem->edges() > largeProblem) returnFreeMemory();
  }

  /// What a function of the user's throws passes through, after the best estimate so far was stored.
  void descendOrKeep(Descent& descent, const NamedEntry<Algorithm>* algorithm, bool damped) {
    const GraphWatch watch(problem->graph());
    try {
      descend(descent, algorithm, damped, summary.plan);
    } catch (...) {
      if (watch.unchanged()) {
        descent.end();
        problem->store();
      } else {
        key = {};  // what was compiled points to elements that may be gone
      }
      throw;
    }
  }
};

Optimizer::Optimizer(Options options) : options_(std::move(options)), compiled_(std::make_unique<Compiled>()) {}
Optimizer::~Optimizer() = default;
Optimizer::Optimizer(Optimizer&& other) noexcept
    : options_(std::exchange(other.options_, Options())), compiled_(std::move(other.compiled_)) {}
Optimizer& Optimizer::operator=(Optimizer&& other) noexcept {
  if (this == &other) return *this;
  options_ = std::exchange(other.options_, Options());
  compiled_ = std::move(other.compiled_);
  return *this;
}
bool Optimizer::reused() const { return compiled_ && compiled_->reused; }
Options& Optimizer::options() { return options_; }

Problem& Optimizer::compile(Graph& graph) {
  options_.validate();
  if (!compiled_) compiled_ = std::make_unique<Compiled>();
  compiled_->compile(graph, options_, true);
  return *compiled_->problem;
}

Summary& Optimizer::run(Graph& graph, bool again) {
  options_.validate();
  if (!compiled_) compiled_ = std::make_unique<Compiled>();  // after a move
  const Stopwatch whole;
  const StopCondition stop(options_.timeLimit, options_.stopToken);
  Summary& summary = compiled_->summary;
  summary.clear();
  summary.threads = threadsOf(options_);
  solve(graph, again, options_, stop);
  if (summary.status == Status::converged && !compiled_->holds.empty() &&
      compiled_->holds.bites(*compiled_->problem, summary.finalCost, options_.costTolerance)) {
    const Summary first = summary;
    const SavedEstimates converged(graph);
    Options released = options_;
    released.gauge = GaugePolicy::free;
    solve(graph, false, released, stop);
    constexpr double gain = 1e-9;
    const bool failed = summary.status == Status::numericalFailure || summary.status == Status::memoryLimit;
    if (!failed && summary.finalCost < (1.0 - gain) * first.finalCost) {
      summary.initialChi2 = first.initialChi2;
      summary.initialCost = first.initialCost;
      summary.gauge.reason = first.gauge.reason + "; released where that kept the cost from falling further";
    } else {
      // What was held was free after all.
      summary = first;
      converged.restore(graph);
    }
  }
  summary.seconds.total = whole.seconds();
  return summary;
}

void Optimizer::solve(Graph& graph, bool again, const Options& options, const StopCondition& stop) {
  if (attempt(graph, again, options, stop)) return;
  // Once more from the same estimates, which the graph still has, with everything compiled anew.
  compiled_->key = {};
  compiled_->summary.clear();
  compiled_->summary.threads = threadsOf(options);
  (void)attempt(graph, again, options, stop);
}

bool Optimizer::attempt(Graph& graph, bool again, const Options& options, const StopCondition& stop) {
  Stopwatch watch;
  Summary& summary = compiled_->summary;
  const NamedEntry<Algorithm>* const algorithm = algorithmOf(options, *graph.registry());
  if (const std::int64_t bytes = options.memoryLimit > 0 ? estimateCompilation(graph, options) : 0;
      bytes > options.memoryLimit) {
    reportUnmoved(nullptr, Status::memoryLimit, describeExcess(bytes, options), summary);
    return true;
  }
  compiled_->compile(graph, options, again);
  Problem& problem = *compiled_->problem;
  const StopGuard guard(problem, stop);
  const bool settled = compiled_->settle(options, algorithm);
  if (problem.edges() > largeProblem && !compiled_->reused) returnFreeMemory();
  summary.gauge = compiled_->gauge;
  summary.edges = problem.edges();
  summary.isolated.assign(problem.isolated().begin(), problem.isolated().end());
  summary.variables = problem.variables();
  problem.setRobustCorrection(options.robustCorrection);
  // What would be run, should it not come to that.
  chooseAlgorithm(algorithm, hasRobustKernel(problem), summary.gauge, summary.plan);
  summary.seconds.compile += watch.lap();
  if (problem.variables() == 0) {
    reportUnmoved(&problem, Status::nothingToOptimise,
                  problem.edges() == 0 ? "no edge takes part" : "every vertex that an edge touches is fixed", summary);
    return true;
  }
  if (!settled || stop.reached()) {
    reportStopped(problem, stop, summary);
    return true;
  }
  compiled_->analyze(options, summary.threads);
  summary.plan = compiled_->system->plan();
  summary.seconds.analyze += watch.lap();
  if (summary.plan.exceedsMemory) {
    reportUnmoved(&problem, Status::memoryLimit,
                  describeExcess(estimateCompilation(graph, options) + summary.plan.bytes, options), summary);
    compiled_->system.reset();
    return true;
  }
  const bool damped = chooseAlgorithm(algorithm, hasRobustKernel(problem), summary.gauge, summary.plan);
  announce(options, graph, "optimising");
  Descent descent(problem, *compiled_->system, options, stop, compiled_->memory, summary);
  compiled_->descendOrKeep(descent, algorithm, damped);
  if (compiled_->doubtsGauge()) return false;
  summary.plan.singular = compiled_->system->plan().singular;
  problem.store();
  summary.seconds.optimize += watch.lap();
  return true;
}

Summary optimize(Graph& graph, const Options& options) { return std::move(Optimizer(options).run(graph, false)); }

}  // namespace quiver
