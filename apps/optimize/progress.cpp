#include <quiver/apps/optimize/progress.h>

#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {

Progress::Progress(std::FILE* stream) : stream_(stream), terminal_(stream && isatty(fileno(stream)) != 0) {}

void Progress::iteration(const IterationReport& report) {
  if (!stream_) return;
  if (terminal_) {
    // Back to the first column, and clear what the last line leaves behind.
    tell(stream_, "\r\x1b[Kiteration {}  chi2 {:.9g}  {:.1f} ms", report.iteration, report.chi2,
         report.seconds.total * 1e3);
  } else {
    if (!begun_) tell(stream_, "{}\n", iterationHeading());
    tell(stream_, "{}\n", iterationLine(report));
  }
  begun_ = true;
  std::fflush(stream_);
}

void Progress::finish(const Summary& summary) {
  if (!stream_) return;
  if (terminal_ && begun_) {
    tell(stream_, "\r\x1b[K{}\n", iterationHeading());
    for (const IterationReport& report : summary.iterations) tell(stream_, "{}\n", iterationLine(report));
  }
  tell(stream_, "{}", closingText(summary));
  std::fflush(stream_);
}

std::string closingText(const Summary& summary) {
  const SolvePlan& plan = summary.plan;
  std::string text;
  if (!plan.algorithm.empty() && !plan.linearSolver.empty()) {
    text += fmt::format("algorithm {} ({}), linear solver {}, ordering {}, {} thread{}\n", plan.algorithm,
                        plan.algorithmReason, plan.linearSolver, plan.ordering.empty() ? "none" : plan.ordering,
                        summary.threads, summary.threads == 1 ? "" : "s");
  }
  if (!summary.gauge.reason.empty()) text += fmt::format("gauge: {}\n", summary.gauge.reason);
  if (!summary.isolated.empty()) {
    const bool one = summary.isolated.size() == 1;
    text += fmt::format("{} no edge touches left as {} (the first is {})\n",
                        counted(static_cast<std::int64_t>(summary.isolated.size()), "vertex that", "vertices that"),
                        one ? "it is" : "they are", summary.isolated.front());
  }
  text += fmt::format("{}: {}\n", toString(summary.status), summary.reason);
  if (!std::isfinite(summary.initialChi2)) return text;
  text += fmt::format("chi2 {:.10g} -> {:.10g} with {} and {} in {:.3f} s\n", summary.initialChi2, summary.finalChi2,
                      counted(summary.variables, "free vertex", "free vertices"), counted(summary.edges, "edge"),
                      summary.seconds.total);
  return text;
}

}  // namespace quiver::app
