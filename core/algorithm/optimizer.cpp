#include <quiver/core/algorithm/optimizer.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <quiver/core/algorithm/descent.h>
#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/structure_key.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>

namespace quiver {
namespace {

enum class Algorithm { automatic, gaussNewton, levenbergMarquardt };

Algorithm algorithmOf(const Options& options) {
  if (options.algorithm == "auto") return Algorithm::automatic;
  if (options.algorithm == "gn") return Algorithm::gaussNewton;
  if (options.algorithm == "lm") return Algorithm::levenbergMarquardt;
  throw GraphError(fmt::format("no algorithm '{}'; there are auto, gn and lm", options.algorithm));
}

std::unique_ptr<LinearSystem> makeSystem(const Registry& registry, const Options& options) {
  if (const LinearSystemFactory* factory = registry.findLinearSystem(options.linearSolver)) return (*factory)(options);
  std::string known;
  for (const auto& entry : registry.linearSystems()) known += (known.empty() ? "" : ", ") + entry.name;
  throw GraphError(
      fmt::format("no linear solver '{}'; the registry has {}", options.linearSolver, known.empty() ? "none" : known));
}

std::string describeGauge(const GaugeReport& report, bool fixes, int found) {
  const std::string components = report.components == 1 ? "" : fmt::format(" in {} components", report.components);
  if (found == 0) return fmt::format("nothing is free{}", components);
  if (!fixes) return fmt::format("{} directions are free{} and left so", found, components);
  std::string ids;
  for (const std::int64_t id : report.fixed) ids += fmt::format("{}{}", ids.empty() ? "" : ", ", id);
  return fmt::format("{} directions are free{}; vertex {} held", found, components, ids);
}

/// Detects the gauge and, if the policy says so, holds one vertex a component.
void settleGauge(Problem& problem, const Options& options, Algorithm algorithm, GaugeReport& report) {
  const bool fixes = options.gauge == GaugePolicy::fix ||
                     (options.gauge == GaugePolicy::automatic && algorithm != Algorithm::levenbergMarquardt);
  const std::vector<ComponentGauge> gauges = findGauges(problem);
  report.components = static_cast<int>(gauges.size());
  std::vector<int> anchors;
  int found = 0;
  for (const ComponentGauge& gauge : gauges) {
    found += gauge.free;
    if (gauge.free == 0 || !fixes) continue;
    anchors.push_back(gauge.anchor);
    report.fixed.push_back(problem.vertex(problem.slotOfVariable(gauge.anchor)).id());
  }
  report.free = fixes ? 0 : found;
  report.reason = describeGauge(report, fixes, found);
  if (!anchors.empty()) problem.fixVariables(anchors);
}

void reportNothing(Problem& problem, Summary& summary) {
  const CostTotals totals = problem.evaluate(problem.state());
  summary.initialChi2 = summary.finalChi2 = totals.chi2;
  summary.initialCost = summary.finalCost = totals.cost;
  summary.status = Status::nothingToOptimise;
  summary.reason = problem.edges() == 0 ? "no edge takes part" : "every vertex that an edge touches is fixed";
}

void descend(Descent& descent, Algorithm algorithm, SolvePlan& plan) {
  if (descent.begin()) {
    switch (algorithm) {
      case Algorithm::gaussNewton:
        gaussNewton(descent, false);
        break;
      case Algorithm::levenbergMarquardt:
        levenbergMarquardt(descent);
        break;
      case Algorithm::automatic:
        if (!gaussNewton(descent, true)) {
          plan.algorithm = "gn, then lm";
          plan.algorithmReason = "a full step failed, so steps are damped from there";
          levenbergMarquardt(descent);
        }
        break;
    }
  }
  descent.end();
}

}  // namespace

/// What one call leaves for the next.
struct Optimizer::Compiled {
  StructureKey key;
  std::unique_ptr<Problem> problem;
  std::unique_ptr<LinearSystem> system;
  GaugeReport gauge;
  bool reused = false;
};

Optimizer::Optimizer(Options options) : options_(std::move(options)), compiled_(std::make_unique<Compiled>()) {}
Optimizer::~Optimizer() = default;
Optimizer::Optimizer(Optimizer&&) noexcept = default;
Optimizer& Optimizer::operator=(Optimizer&&) noexcept = default;
bool Optimizer::reused() const { return compiled_->reused; }
Options& Optimizer::options() { return options_; }

Summary Optimizer::optimize(Graph& graph) {
  options_.validate();
  const Algorithm algorithm = algorithmOf(options_);
  Stopwatch watch;
  const Stopwatch whole;
  const StopCondition stop(options_.timeLimit, options_.stopToken);
  Summary summary;
  summary.threads = options_.threads > 0 ? options_.threads : hardwareThreads();
  Compiled& now = *compiled_;
  const StructureKey key(graph, options_, summary.threads);
  now.reused = now.problem && key == now.key;
  if (now.reused) {
    now.problem->refresh();
  } else {
    now.system.reset();
    now.problem.reset();
    now.gauge = {};
    now.problem = std::make_unique<Problem>(graph, ProblemScope{options_.level, options_.free, summary.threads});
    if (now.problem->variables() > 0) settleGauge(*now.problem, options_, algorithm, now.gauge);
    now.key = key;
  }
  Problem& problem = *now.problem;
  summary.gauge = now.gauge;
  summary.edges = problem.edges();
  summary.isolated.assign(problem.isolated().begin(), problem.isolated().end());
  summary.variables = problem.variables();
  summary.seconds.compile = watch.lap();
  if (problem.variables() == 0) {
    reportNothing(problem, summary);
  } else {
    if (!now.system) {
      now.system = makeSystem(*graph.registry(), options_);
      now.system->analyze(problem, options_, summary.threads);
    }
    summary.plan = now.system->plan();
    summary.plan.algorithm = algorithm == Algorithm::levenbergMarquardt ? "lm" : "gn";
    summary.plan.algorithmReason =
        algorithm == Algorithm::automatic ? "full steps while they lower the cost" : "as asked";
    summary.seconds.analyze = watch.lap();
    Descent descent(problem, *now.system, options_, stop, summary);
    descend(descent, algorithm, summary.plan);
    problem.store();
    summary.seconds.optimize = watch.lap();
  }
  summary.seconds.total = whole.seconds();
  return summary;
}

Summary optimize(Graph& graph, const Options& options) { return Optimizer(options).optimize(graph); }

}  // namespace quiver
