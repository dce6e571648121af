// Pose graphs: quiver against Ceres on the same errors, two threads, taking turns: the median iteration of
// Levenberg–Marquardt, and from the file to the optimum in a process of its own, reading and starting included.
//   quiver_bench_ceres [--json FILE] [--rounds N] [--any-blas] [GRAPH.g2o...]
#include <cstdio>
#include <limits>

#include <quiver/apps/support/freed_memory.h>
#include <quiver/quiver.h>

#include "peers/blas.h"
#include "peers/ceres_pose_graph.h"
#include "peers/measure.h"
#include "peers/separate_process.h"

using namespace quiver;

namespace {

constexpr int threads = 2;
constexpr int timedIterations = 9;
constexpr int mostIterations = 200;
/// Ends count as the same optimum within this.
constexpr double sameOptimum = 1e-6;

/// Seconds of the median iteration of Levenberg–Marquardt with the first pose held, from the file's start.
double quiverIteration(const Graph& start) {
  Graph graph(start);
  bench::settle();
  const Summary summary = optimize(graph, {.maxIterations = timedIterations,
                                           .algorithm = "lm",
                                           .gauge = GaugePolicy::fix,
                                           .threads = threads,
                                           .costTolerance = 0.0,
                                           .gradientTolerance = 0.0,
                                           .stepTolerance = 0.0});
  std::vector<double> seconds;
  for (const IterationReport& report : summary.iterations) seconds.push_back(report.seconds.total);
  return bench::median(seconds);
}

double ceresIteration(const std::string& file) {
  bench::settle();
  return bench::solveWithCeres(file, timedIterations, threads, false).iterationSeconds;
}

/// Seconds from starting a process to its end; it writes the chi2 that `work` returns. Its heap is that of the command,
/// for either side.
template <typename Work>
double processSeconds(Work&& work, double& chi2) {
  bench::SeparateResult result;
  const double seconds = bench::secondsOf([&] {
    result = bench::inSeparateProcess([&] {
      app::keepFreedMemory();
      return fmt::format("{:.17g}", work());
    });
  });
  chi2 = result.ok ? std::stod(result.text) : std::numeric_limits<double>::quiet_NaN();
  return seconds;
}

/// A graph from its file to the optimum, both sides.
struct Whole {
  bench::Pair seconds;
  double chi2 = 0.0;
  double theirChi2 = 0.0;
  bool same() const { return std::abs(chi2 - theirChi2) <= sameOptimum * std::min(chi2, theirChi2); }
};

Whole measureWhole(const std::string& file, const std::shared_ptr<const Registry>& registry, int rounds) {
  Whole whole;
  const auto ours = [&] {
    Graph graph = readGraph(file, registry, {.threads = threads});
    (void)automaticStart(graph, {.threads = threads});
    return optimize(graph, {.threads = threads}).finalChi2;
  };
  const auto theirs = [&] { return bench::solveWithCeres(file, mostIterations, threads, true).chi2; };
  whole.seconds = bench::comparePairs(
      rounds, [&] { return processSeconds(ours, whole.chi2); },
      [&] { return processSeconds(theirs, whole.theirChi2); });
  return whole;
}

void report(bench::JsonRows& json, const std::string& name, const bench::Pair& iteration, const Whole& whole) {
  fmt::print("{:<15} {:>10.3f} {:>10.3f} {:>6.1f}x | {:>12.4f} {:>11.4f} {:>6.1f}x {:>14.8g} {:>14.8g}{}\n", name,
             1e3 * iteration.ours, 1e3 * iteration.theirs, iteration.ratio, whole.seconds.ours, whole.seconds.theirs,
             whole.seconds.ratio, whole.chi2, whole.theirChi2, whole.same() ? "" : "  (not the same optimum)");
  std::fflush(stdout);
  json.begin(name);
  json.add("iteration_seconds", iteration.ours);
  json.add("ceres_iteration_seconds", iteration.theirs);
  json.add("iteration_ratio", iteration.ratio);
  json.add("optimum_seconds", whole.seconds.ours);
  json.add("ceres_optimum_seconds", whole.seconds.theirs);
  json.add("optimum_ratio", whole.same() ? whole.seconds.ratio : std::numeric_limits<double>::quiet_NaN());
  json.add("chi2", whole.chi2);
  json.add("ceres_chi2", whole.theirChi2);
}

void reportMean(bench::JsonRows& json, const std::vector<Whole>& all) {
  double logarithms = 0.0;
  int count = 0;
  for (const Whole& whole : all) {
    if (!whole.same()) continue;
    logarithms += std::log(whole.seconds.ratio);
    ++count;
  }
  if (count == 0) return;
  const double mean = std::exp(logarithms / count);
  fmt::print("to the same optimum on {} graphs: {:.1f}x, geometric mean\n", count, mean);
  json.begin("geometric mean");
  json.add("optimum_ratio", mean);
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
  // Processes first: a child has none of the threads that its parent started.
  std::vector<Whole> wholes;
  for (const std::string& file : arguments.graphs) wholes.push_back(measureWhole(file, registry, arguments.rounds));
  app::keepFreedMemory();
  fmt::print("{:<15} {:>10} {:>10} {:>7} | {:>11} {:>11} {:>7} {:>14} {:>14}\n", "graph", "iter ms", "Ceres ms",
             "ratio", "to optimum s", "Ceres s", "ratio", "chi2", "Ceres' chi2");
  for (std::size_t i = 0; i < arguments.graphs.size(); ++i) {
    const std::string& file = arguments.graphs[i];
    const Graph start = readGraph(file, registry);
    const bench::Pair iteration = bench::comparePairs(
        arguments.rounds, [&] { return quiverIteration(start); }, [&] { return ceresIteration(file); });
    report(json, std::filesystem::path(file).stem().string(), iteration, wholes[i]);
  }
  reportMean(json, wholes);
  json.write(arguments.json);
}
