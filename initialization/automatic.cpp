#include <quiver/initialization/automatic.h>

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/algorithm/memory_estimate.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/estimates.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/initialization/chordal.h>
#include <quiver/initialization/pose_graph.h>
#include <quiver/initialization/spanning_tree.h>

namespace quiver {
namespace {

double chi2Of(Problem& problem) {
  const CostTotals totals = problem.evaluate(problem.state());
  return totals.finite() ? totals.chi2 : HUGE_VAL;
}

/// Numbers that the measurements have more than the free vertices: what chi2 is at a solution, on average.
std::int64_t redundancy(const Problem& problem) {
  std::int64_t residuals = 0;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    if (batch.uniform()) {
      residuals += std::int64_t{batch.size()} * batch.largestShape().rows;
    } else {
      for (int edge = 0; edge < batch.size(); ++edge) residuals += batch.shape(edge).rows;
    }
  }
  return residuals - problem.scalars();
}

}  // namespace

AutomaticStart automaticStart(Graph& graph, const Options& options) {
  Optimizer optimizer(options);
  return automaticStart(graph, optimizer);
}

AutomaticStart automaticStart(Graph& graph, Optimizer& optimizer) {
  const Options& options = optimizer.options();
  const Stopwatch watch;
  const StopCondition stop(options.timeLimit, options.stopToken);
  bool complete = true;
  std::as_const(graph).forEachVertex([&](const Vertex& vertex) { complete = complete && vertex.hasEstimate(); });
  AutomaticStart start{complete ? "file" : "tree",
                       complete ? "the file's estimates" : spanningTreeEstimate(graph, options)};
  // Landmarks whose estimates were given must not be lost to a start that cannot tell them; free subsets start where
  // they are.
  if (!options.free.empty() || !hasRelativePoses(graph, options)) return start;
  // What would not fit is refused by the solve.
  if (options.memoryLimit > 0 && estimateCompilation(graph, options) > options.memoryLimit) return start;
  Problem& problem = optimizer.compile(graph);
  const double before = start.firstChi2 = chi2Of(problem);
  const auto redundant = static_cast<double>(redundancy(problem));
  if (before <= redundant) {
    start.reason += fmt::format(": chi2 {:.6g} is within the noise of {} redundant measurement{}", before, redundant,
                                redundant == 1.0 ? "" : "s");
    return start;
  }
  const auto remaining = [&] {
    Options rest = options;
    rest.timeLimit -= watch.seconds();
    return rest;
  };
  double lowest = before;
  const auto consider = [&](const char* name, const Initializer& initializer) {
    if (stop.reached()) return;
    EstimatesGuard guard(graph);
    try {
      const std::string words = initializer(graph, remaining());
      problem.refresh();
      const double after = chi2Of(problem);
      if (after < lowest) {
        start = {name, fmt::format("{}: chi2 {:.6g}, lower than {:.6g} of {}", words, after, lowest, start.reason),
                 before};
        lowest = after;
        guard.keep();
      }
    } catch (const GraphError&) {
      // No such start for this graph: not an error, the other one stands.
    } catch (const WorkStopped&) {
      // Nor is one that takes too long.
    }
  };
  consider("chordal", chordalEstimate);
  if (const Initializer* points = graph.registry()->findInitializer("points"); points && lowest > redundant)
    consider("points", *points);
  return start;
}

std::string automaticEstimate(Graph& graph, const Options& options) { return automaticStart(graph, options).reason; }

}  // namespace quiver
