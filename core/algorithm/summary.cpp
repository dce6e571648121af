#include <quiver/core/algorithm/summary.h>

#include <cmath>
#include <ostream>

#include <fmt/format.h>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/util/error.h>

namespace quiver {

std::string_view toString(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::iterationLimit:
      return "iteration_limit";
    case Status::timeLimit:
      return "time_limit";
    case Status::interrupted:
      return "interrupted";
    case Status::stalled:
      return "stalled";
    case Status::numericalFailure:
      return "numerical_failure";
    case Status::nothingToOptimise:
      return "nothing_to_optimise";
    case Status::memoryLimit:
      return "memory_limit";
  }
  throw LogicError(fmt::format("no such status: {}", static_cast<int>(status)));
}

void Summary::clear() {
  // A copy's strings and vectors take the memory that is there.
  const Summary fresh;
  *this = fresh;
}

void Options::validate() const {
  const auto demand = [](bool holds, const char* what, double value) {
    if (!holds) throw GraphError(fmt::format("option {} is {}: {}", what, value, "it must be 0 or more"));
  };
  demand(maxIterations >= 0, "maxIterations", maxIterations);
  demand(threads >= 0, "threads", threads);
  constexpr int mostThreads = 4096;
  if (threads > mostThreads)
    throw GraphError(fmt::format("option threads is {}: it must be {} or less", threads, mostThreads));
  demand(timeLimit >= 0.0, "timeLimit", timeLimit);
  const auto demandTolerance = [](double value, const char* what) {
    if (!(value >= 0.0) || !std::isfinite(value))
      throw GraphError(fmt::format("option {} is {}: it must be 0 or more, and finite", what, value));
  };
  demandTolerance(costTolerance, "costTolerance");
  demandTolerance(gradientTolerance, "gradientTolerance");
  demandTolerance(stepTolerance, "stepTolerance");
  if (level < -1) throw GraphError(fmt::format("option level is {}: it must be a level, or -1 for all", level));
  demand(memoryLimit >= 0, "memoryLimit", static_cast<double>(memoryLimit));
  demand(maxLinearIterations >= 0, "maxLinearIterations", maxLinearIterations);
  if (!(linearTolerance > 0.0) || !(linearTolerance < 1.0))
    throw GraphError(fmt::format("option linearTolerance is {}: it must lie between 0 and 1", linearTolerance));
  if (!(initialDamping > 0.0) || !std::isfinite(initialDamping))
    throw GraphError(fmt::format("option initialDamping is {}: it must be positive and finite", initialDamping));
}

std::string iterationHeading() {
  return fmt::format("{:>4}  {:>16}  {:>16}  {:>9}  {:>9}  {:>9}  {:>9}  {}", "iter", "chi2", "cost", "damping", "step",
                     "gradient", "ms", "");
}

std::string iterationLine(const IterationReport& report) {
  return fmt::format("{:>4}  {:>16.9g}  {:>16.9g}  {:>9.2e}  {:>9.2e}  {:>9.2e}  {:>9.3f}  {}", report.iteration,
                     report.chi2, report.cost, report.damping, report.relativeStep, report.gradient,
                     report.seconds.total * 1e3, report.accepted ? "" : "rejected");
}

std::ostream& operator<<(std::ostream& out, const Summary& summary) {
  if (!summary.iterations.empty()) {
    out << iterationHeading() << '\n';
    for (const IterationReport& report : summary.iterations) out << iterationLine(report) << '\n';
  }
  const SolvePlan& plan = summary.plan;
  if (!plan.algorithm.empty()) {
    out << fmt::format("algorithm {} ({})", plan.algorithm, plan.algorithmReason);
    if (!plan.linearSolver.empty())
      out << fmt::format(", linear solver {}, ordering {}", plan.linearSolver,
                         plan.ordering.empty() ? "none" : plan.ordering);
    out << '\n';
  }
  if (!summary.gauge.reason.empty()) out << "gauge: " << summary.gauge.reason << '\n';
  out << fmt::format("{}: {}\n", toString(summary.status), summary.reason);
  if (!std::isfinite(summary.initialChi2)) return out;
  out << fmt::format("chi2 {:.10g} -> {:.10g} with {} vertices and {} edges in {:.3f} s\n", summary.initialChi2,
                     summary.finalChi2, summary.variables, summary.edges, summary.seconds.total);
  return out;
}

}  // namespace quiver
