#include <quiver/apps/optimize/optimize_report.h>

#include <sys/resource.h>

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include <quiver/version.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

/// What is not finite is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json describeIteration(const IterationReport& report) {
  const PhaseSeconds& seconds = report.seconds;
  return {{"iteration", report.iteration},
          {"chi2", number(report.chi2)},
          {"cost", number(report.cost)},
          {"accepted", report.accepted},
          {"damping", number(report.damping)},
          {"relative_step", number(report.relativeStep)},
          {"gradient", number(report.gradient)},
          {"linear_iterations", report.linearIterations},
          {"seconds",
           {{"linearize", seconds.linearize},
            {"assemble", seconds.assemble},
            {"eliminate", seconds.eliminate},
            {"factorize", seconds.factorize},
            {"solve", seconds.solve},
            {"update", seconds.update},
            {"evaluate", seconds.evaluate},
            {"total", seconds.total}}}};
}

/// The rate is that of the fastest factorisation: the others wait for memory and other programs.
Json describeFactor(const Summary& summary) {
  double fastest = std::numeric_limits<double>::infinity();
  for (const IterationReport& report : summary.iterations) {
    if (report.seconds.factorize > 0.0) fastest = std::min(fastest, report.seconds.factorize);
  }
  const double rate =
      std::isfinite(fastest) ? summary.plan.factorFlops / fastest * 1e-9 : std::numeric_limits<double>::quiet_NaN();
  return {{"nonzeros", summary.plan.factorNonzeros},
          {"flops", number(summary.plan.factorFlops)},
          {"gflops_per_second", number(rate)}};
}

Json describeDecisions(const Summary& summary) {
  const SolvePlan& plan = summary.plan;
  Json json;
  json["algorithm"] = plan.algorithm;
  json["linear_solver"] = plan.linearSolver;
  json["ordering"] = plan.ordering;
  json["threads"] = summary.threads;
  json["elimination"] = {
      {"eliminated", plan.eliminated}, {"types", plan.eliminatedTypes}, {"reason", plan.eliminationReason}};
  json["gauge"] = {{"fixed", summary.gauge.fixed},
                   {"free", summary.gauge.free},
                   {"components", summary.gauge.components},
                   {"reason", summary.gauge.reason}};
  return json;
}

}  // namespace

std::int64_t peakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

Json describeRun(const OptimizeReport& report, const Json& input) {
  const Summary& summary = report.summary;
  Json json;
  json["quiver"] = QUIVER_VERSION;
  json["input"] = input;
  json.update(describeDecisions(summary));
  json["initial_guess"] = report.guess.name;
  json["initial_guess_reason"] = report.guess.reason;
  json["status"] = toString(summary.status);
  json["reason"] = summary.reason;
  json["file_chi2"] = number(report.fileChi2);
  json["initial_chi2"] = number(summary.initialChi2);
  json["final_chi2"] = number(summary.finalChi2);
  json["initial_cost"] = number(summary.initialCost);
  json["final_cost"] = number(summary.finalCost);
  json["iterations"] = Json::array();
  for (const IterationReport& iteration : summary.iterations)
    json["iterations"].push_back(describeIteration(iteration));
  json["factor"] = describeFactor(summary);
  json["seconds"] = {{"load", report.loadSeconds},           {"initialize", report.initializeSeconds},
                     {"compile", summary.seconds.compile},   {"analyze", summary.seconds.analyze},
                     {"optimize", summary.seconds.optimize}, {"save", report.saveSeconds},
                     {"total", report.totalSeconds}};
  if (std::isfinite(report.marginalsSeconds)) json["seconds"]["marginals"] = report.marginalsSeconds;
  if (report.marginals) {
    json["marginals"] = {{"written", report.marginals->reason.empty()},
                         {"vertices", report.marginals->vertices},
                         {"undetermined", report.marginals->undetermined},
                         {"relative_error", number(report.marginals->relativeError)},
                         {"reason", report.marginals->reason}};
  }
  json["peak_memory_bytes"] = peakMemoryBytes();
  return json;
}

}  // namespace quiver::app
