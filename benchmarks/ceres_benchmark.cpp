// Pose graphs: quiver against Ceres on the same errors, two threads, taking turns: a whole iteration of
// Levenberg–Marquardt, and from the file to the optimum.
//   quiver_bench_ceres [--json FILE] [--rounds N] [--any-blas] [GRAPH.g2o...]
#include <cstdio>
#include <limits>

#include <quiver/quiver.h>

#include "peers/blas.h"
#include "peers/ceres_pose_graph.h"
#include "peers/measure.h"

using namespace quiver;

namespace {

constexpr int threads = 2;
constexpr int timedIterations = 5;
constexpr int mostIterations = 200;
/// Ends count as the same optimum within this.
constexpr double sameOptimum = 1e-6;

/// Seconds of one iteration of Levenberg–Marquardt with the first pose held, from the file's start.
double quiverIteration(const Graph& start) {
  Graph graph(start);
  const Summary summary = optimize(graph, {.maxIterations = timedIterations,
                                           .algorithm = "lm",
                                           .gauge = GaugePolicy::fix,
                                           .threads = threads,
                                           .costTolerance = 0.0,
                                           .gradientTolerance = 0.0,
                                           .stepTolerance = 0.0});
  double seconds = 0.0;
  for (const IterationReport& report : summary.iterations) seconds += report.seconds.total;
  return seconds / static_cast<double>(summary.iterations.size());
}

double ceresIteration(const std::string& file) {
  const bench::CeresResult result = bench::solveWithCeres(file, timedIterations, threads, false);
  return result.iterationSeconds / result.iterations;
}

}  // namespace

int main(int count, char** words) {
  const bench::Arguments arguments(count, words,
                                   {"intel", "M3500", "sphere2500", "sphere_noisy", "torus3D", "parking-garage"});
  try {
    bench::demandBlas(arguments.anyBlas);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  const auto registry = builtinRegistry();
  bench::JsonRows json;
  fmt::print("{:<15} {:>10} {:>10} {:>7} | {:>11} {:>11} {:>7} {:>14} {:>14}\n", "graph", "iter ms", "Ceres ms",
             "ratio", "to optimum s", "Ceres s", "ratio", "chi2", "Ceres' chi2");
  for (const std::string& file : arguments.graphs) {
    const std::string name = std::filesystem::path(file).stem().string();
    const Graph start = readGraph(file, registry);
    const bench::Pair iteration = bench::comparePairs(
        arguments.rounds, [&] { return quiverIteration(start); }, [&] { return ceresIteration(file); });
    double chi2 = 0.0;
    bench::CeresResult theirs;
    const bench::Pair whole = bench::comparePairs(
        arguments.rounds,
        [&] {
          return bench::secondsOf([&] {
            Graph graph = readGraph(file, registry, {.threads = threads});
            chi2 = optimize(graph, {.threads = threads}).finalChi2;
          });
        },
        [&] {
          theirs = bench::solveWithCeres(file, mostIterations, threads, true);
          return theirs.loadSeconds + theirs.solveSeconds;
        });
    const bool same = std::abs(chi2 - theirs.chi2) <= sameOptimum * std::min(chi2, theirs.chi2);
    fmt::print("{:<15} {:>10.3f} {:>10.3f} {:>6.1f}x | {:>12.4f} {:>11.4f} {:>6.1f}x {:>14.8g} {:>14.8g}{}\n", name,
               1e3 * iteration.ours, 1e3 * iteration.theirs, iteration.ratio, whole.ours, whole.theirs, whole.ratio,
               chi2, theirs.chi2, same ? "" : "  (not the same optimum)");
    std::fflush(stdout);
    json.begin(name);
    json.add("iteration_seconds", iteration.ours);
    json.add("ceres_iteration_seconds", iteration.theirs);
    json.add("iteration_ratio", iteration.ratio);
    json.add("optimum_seconds", whole.ours);
    json.add("ceres_optimum_seconds", whole.theirs);
    json.add("optimum_ratio", same ? whole.ratio : std::numeric_limits<double>::quiet_NaN());
    json.add("chi2", chi2);
    json.add("ceres_chi2", theirs.chi2);
  }
  json.write(arguments.json);
}
