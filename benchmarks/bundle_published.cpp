#include "bundle_published.h"

#include <cstdio>

#include <quiver/apps/support/freed_memory.h>

#include "peers/separate_process.h"
#if QUIVER_BENCH_CERES
#  include "bundle_ceres.h"
#endif

namespace quiver::bench {
namespace {

constexpr int threads = 2;
constexpr int timedIterations = 20;

#if QUIVER_BENCH_CERES

/// Seconds of `work` in a process of its own, whose heap is that of the command, for either side.
template <typename Work>
double processSeconds(Work&& work) {
  return secondsOf([&] {
    const SeparateResult result = inSeparateProcess([&] {
      app::keepFreedMemory();
      work();
      return std::string();
    });
    if (!result.ok) throw Error("a process of the benchmark failed");
  });
}

void compareIterations(const std::string& file, const std::string& name, bool sparse, const Pair& whole, int rounds,
                       JsonRows& json) {
  const Graph start = readGraph(file, builtinRegistry());
  double cost = 0.0;
  double theirCost = 0.0;
  const Pair iteration = comparePairs(
      rounds,
      [&] {
        Graph graph(start);
        settle();
        const Summary summary = optimize(graph, untilIterations(timedIterations));
        cost = 0.5 * summary.finalCost;
        return iterationSeconds(summary);
      },
      [&] {
        settle();
        const CeresBundleResult result = solveBundleWithCeres(file, timedIterations, threads, sparse);
        theirCost = result.cost;
        return result.iterationSeconds / result.iterations;
      });
  fmt::print(
      "{:<18} {:<12} iteration {:>7.3f} ms, Ceres {:>7.3f} ms, {:>5.1f}x; whole {:>7.2f} ms, Ceres {:>8.2f} ms, "
      "{:>5.1f}x; cost {:.8g}, Ceres {:.8g}\n",
      name, sparse ? "sparse Schur" : "dense Schur", 1e3 * iteration.ours, 1e3 * iteration.theirs, iteration.ratio,
      1e3 * whole.ours, 1e3 * whole.theirs, whole.ratio, cost, theirCost);
  const std::string key = sparse ? "sparse_" : "dense_";
  json.add(key + "iteration_seconds", iteration.ours);
  json.add(key + "ceres_iteration_seconds", iteration.theirs);
  json.add(key + "iteration_ratio", iteration.ratio);
  json.add(key + "whole_seconds", whole.ours);
  json.add(key + "ceres_whole_seconds", whole.theirs);
  json.add(key + "whole_ratio", whole.ratio);
  json.add(key + "ceres_cost", theirCost);
}

#endif

void compareHint(const Graph& start, const std::string& name, int rounds, JsonRows& json) {
  Graph first(start);
  const Summary summary = optimize(first, untilIterations(timedIterations));
  json.add("iteration_seconds", iterationSeconds(summary));
  json.add("cost", 0.5 * summary.finalCost);
  const auto secondsWith = [&](std::vector<std::string> types) {
    Graph graph(start);
    Options options = untilIterations(10);
    options.elimination = types.empty() ? EliminationPolicy::automatic : EliminationPolicy::types;
    options.eliminatedTypes = std::move(types);
    return secondsOf([&] { (void)optimize(graph, options); });
  };
  const Pair hint = comparePairs(
      rounds,
      [&] {
        return secondsWith({summary.plan.eliminatedTypes.begin(), summary.plan.eliminatedTypes.end()});
      },
      [&] { return secondsWith({}); });
  fmt::print("{:<18} without a hint {:.2f} ms for 10 iterations, with the right one {:.2f} ms, {:.2f}x\n", name,
             1e3 * hint.theirs, 1e3 * hint.ours, hint.ratio);
  json.add("no_hint_of_hint", hint.ratio);
}

}  // namespace

Options untilIterations(int iterations) {
  return {.maxIterations = iterations,
          .algorithm = "lm",
          .threads = threads,
          .costTolerance = 0.0,
          .gradientTolerance = 0.0,
          .stepTolerance = 0.0};
}

double iterationSeconds(const Summary& summary) {
  std::vector<double> seconds;
  for (const IterationReport& report : summary.iterations) seconds.push_back(report.seconds.total);
  return median(seconds);
}

std::vector<PublishedWhole> measureWholes([[maybe_unused]] std::span<const std::string> files,
                                          [[maybe_unused]] int rounds) {
  std::vector<PublishedWhole> wholes;
#if QUIVER_BENCH_CERES
  const auto registry = builtinRegistry();
  for (const std::string& file : files) {
    const auto measure = [&](bool sparse) {
      return comparePairs(
          rounds,
          [&] {
            return processSeconds([&] {
              Graph graph = readGraph(file, registry, {.threads = threads});
              (void)optimize(graph, untilIterations(timedIterations));
            });
          },
          [&] { return processSeconds([&] { (void)solveBundleWithCeres(file, timedIterations, threads, sparse); }); });
    };
    wholes.push_back({measure(false), measure(true)});
  }
#endif
  return wholes;
}

void comparePublished(std::span<const std::string> files, [[maybe_unused]] std::span<const PublishedWhole> wholes,
                      int rounds, JsonRows& json) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = std::filesystem::path(files[i]).stem().string();
    json.begin(name);
#if QUIVER_BENCH_CERES
    compareIterations(files[i], name, false, wholes[i].dense, rounds, json);
    compareIterations(files[i], name, true, wholes[i].sparse, rounds, json);
#else
    fmt::print("{:<18} Ceres is not installed\n", name);
#endif
    compareHint(readGraph(files[i], builtinRegistry()), name, rounds, json);
    std::fflush(stdout);
  }
}

}  // namespace quiver::bench
