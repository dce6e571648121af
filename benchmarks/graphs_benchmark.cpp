// Whole graphs as the command does them, default options, each in a process of its own: seconds by phase, time to 1e-3
// and 1e-6 of the optimum, factorisation in GFlop/s and share of the machine, peak memory; simulated worlds of 10^4 to
// 10^6 poses with the exponents at which time and memory grow. Measured peak and bandwidth of the machine come first.
//   quiver_bench_graphs [--json FILE] [--rounds N] [--quick] [GRAPH.g2o...]
// --quick: no world of more than 10^4 poses.
#include <cstdio>
#include <optional>
#include <sstream>

#include <quiver/quiver.h>

#include "factorization/machine_peak.h"
#include "peers/measure.h"
#include "peers/memory_bandwidth.h"
#include "peers/separate_process.h"
#include "peers/simulated_worlds.h"

using namespace quiver;

namespace {

constexpr int threads = 2;

/// Seconds but for counts, chi2 and GFlop/s.
struct Row {
  double poses = 0, edges = 0, load = 0, initialise = 0, compile = 0, analyze = 0, optimize = 0, total = 0;
  double steps = 0, linearize = 0, assemble = 0, factorize = 0, solve = 0, rest = 0, gflops = 0;
  double coarse = 0, fine = 0, chi2 = 0, converged = 0;
};

constexpr std::pair<const char*, double Row::*> columns[] = {{"poses", &Row::poses},
                                                             {"edges", &Row::edges},
                                                             {"load_seconds", &Row::load},
                                                             {"initialise_seconds", &Row::initialise},
                                                             {"compile_seconds", &Row::compile},
                                                             {"analyze_seconds", &Row::analyze},
                                                             {"optimize_seconds", &Row::optimize},
                                                             {"total_seconds", &Row::total},
                                                             {"steps", &Row::steps},
                                                             {"linearize_seconds", &Row::linearize},
                                                             {"assemble_seconds", &Row::assemble},
                                                             {"factorize_seconds", &Row::factorize},
                                                             {"solve_seconds", &Row::solve},
                                                             {"other_seconds", &Row::rest},
                                                             {"factor_gflops", &Row::gflops},
                                                             {"seconds_to_1e-3", &Row::coarse},
                                                             {"seconds_to_1e-6", &Row::fine},
                                                             {"chi2", &Row::chi2},
                                                             {"converged", &Row::converged}};

/// Phases of the steps, the mean of a step; factorisations are fewer than steps when a factor serves again.
void addSteps(const Summary& summary, Row& row) {
  double factorisations = 0.0;
  for (const IterationReport& step : summary.iterations) {
    row.linearize += step.seconds.linearize;
    row.assemble += step.seconds.assemble;
    row.factorize += step.seconds.factorize;
    row.solve += step.seconds.solve;
    row.rest += step.seconds.update + step.seconds.evaluate;
    factorisations += step.seconds.factorize > 0.0 ? 1.0 : 0.0;
  }
  row.steps = static_cast<double>(summary.iterations.size());
  if (row.factorize > 0.0) row.gflops = 1e-9 * summary.plan.factorFlops * factorisations / row.factorize;
  const double count = std::max(1.0, row.steps);
  for (double* phase : {&row.linearize, &row.assemble, &row.solve, &row.rest}) *phase /= count;
  row.factorize /= std::max(1.0, factorisations);
}

/// Seconds from the start of `total` until chi2 was within `share` of its end, whatever the start.
double secondsTo(const Summary& summary, double before, double share) {
  const double good = summary.finalChi2 * (1.0 + share);
  double clock = before;
  if (summary.initialChi2 <= good) return clock;
  for (const IterationReport& step : summary.iterations) {
    clock += step.seconds.total;
    if (step.chi2 <= good) return clock;
  }
  return clock;
}

template <typename Source>
std::string solveOnce(Source&& source) {
  Row row;
  std::optional<Graph> read;
  row.load = bench::secondsOf([&] { read.emplace(source()); });
  Graph& graph = *read;
  row.poses = static_cast<double>(graph.vertexCount());
  row.edges = static_cast<double>(graph.edgeCount());
  const Options options{.threads = threads};
  row.initialise = bench::secondsOf([&] { automaticStart(graph, options); });
  const Summary summary = optimize(graph, options);
  row.compile = summary.seconds.compile;
  row.analyze = summary.seconds.analyze;
  row.optimize = summary.seconds.optimize;
  row.total = row.load + row.initialise + summary.seconds.total;
  addSteps(summary, row);
  const double before = row.load + row.initialise + row.compile + row.analyze;
  row.coarse = secondsTo(summary, before, 1e-3);
  row.fine = secondsTo(summary, before, 1e-6);
  row.chi2 = summary.finalChi2;
  row.converged = summary.converged() ? 1.0 : 0.0;
  std::string text;
  for (const auto& [name, member] : columns) text += fmt::format("{:.17g} ", row.*member);
  return text;
}

struct Outcome {
  Row row;
  double megabytes = 0.0;
  bool ok = false;
};

/// The run of the median total, of `rounds`.
template <typename Source>
Outcome medianRun(int rounds, const Source& source) {
  std::vector<Outcome> all;
  for (int round = 0; round < rounds; ++round) {
    const bench::SeparateResult result = bench::inSeparateProcess([&] { return solveOnce(source); });
    if (!result.ok) return {};
    Outcome outcome{{}, result.peakMegabytes, true};
    std::istringstream text(result.text);
    for (const auto& [name, member] : columns) text >> outcome.row.*member;
    all.push_back(outcome);
  }
  std::sort(all.begin(), all.end(), [](const Outcome& a, const Outcome& b) { return a.row.total < b.row.total; });
  return all[all.size() / 2];
}

void report(bench::JsonRows& json, const std::string& name, const Outcome& outcome, double peak) {
  if (!outcome.ok) {
    fmt::print("{:<18} not finished (out of memory, or an error above)\n", name);
    return;
  }
  const Row& r = outcome.row;
  fmt::print(
      "{:<18} {:>8} {:>8} | {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>9.1f} {:>9.1f} | {:>3} {:>8.3f} {:>8.3f} {:>9.3f} "
      "{:>8.3f} {:>8.3f} | {:>6.1f} {:>4.0f}% | {:>9.1f} {:>9.1f} | {:>8.1f} {:>14.9g}{}\n",
      name, r.poses, r.edges, 1e3 * r.load, 1e3 * r.initialise, 1e3 * r.compile, 1e3 * r.analyze, 1e3 * r.optimize,
      1e3 * r.total, r.steps, 1e3 * r.linearize, 1e3 * r.assemble, 1e3 * r.factorize, 1e3 * r.solve, 1e3 * r.rest,
      r.gflops, 1e11 * r.gflops / peak, 1e3 * r.coarse, 1e3 * r.fine, outcome.megabytes, r.chi2,
      r.converged > 0.0 ? "" : "  (not converged)");
  std::fflush(stdout);
  json.begin(name);
  for (const auto& [key, member] : columns) json.add(key, r.*member);
  json.add("peak_share", 1e9 * r.gflops / peak);
  json.add("peak_megabytes", outcome.megabytes);
}

/// Prints the powers of the number of poses by which a family of worlds grows, from its smallest to its largest.
void reportGrowth(bench::JsonRows& json, const std::string& family, const std::vector<Outcome>& worlds) {
  if (worlds.size() < 2 || !worlds.front().ok || !worlds.back().ok) return;
  const Outcome& small = worlds.front();
  const Outcome& large = worlds.back();
  const double size = std::log(large.row.poses / small.row.poses);
  const double step = std::log(large.row.factorize / small.row.factorize) / size;
  const double whole = std::log(large.row.total / small.row.total) / size;
  const double memory = std::log(large.megabytes / small.megabytes) / size;
  fmt::print(
      "{:<18} time of a factorisation grows as poses^{:.2f}, the whole as poses^{:.2f}, memory as poses^{:.2f}\n",
      family, step, whole, memory);
  json.begin(family + " growth");
  json.add("factorize_exponent", step);
  json.add("total_exponent", whole);
  json.add("memory_exponent", memory);
}

bool hasWord(int count, char** words, const std::string& wanted) {
  return std::find(words + 1, words + count, wanted) != words + count;
}

}  // namespace

int main(int count, char** words) {
  const bench::Arguments arguments(count, words,
                                   {"intel", "intel_odometry", "MIT", "M3500", "manhattan", "parking-garage",
                                    "sphere2500", "sphere_noisy", "torus3D"});
  const bool quick = hasWord(count, words, "--quick") || std::getenv("QUIVER_BENCH_QUICK") != nullptr;
  const auto registry = builtinRegistry();
  bench::JsonRows json;
  const double one = bench::fmaPeak(1);
  const double peak = bench::fmaPeak(threads);
  const double bandwidth[] = {bench::readBandwidth(1), bench::readBandwidth(threads)};
  fmt::print("FMA peak {:.1f} GFlop/s on one thread, {:.1f} on two; reading memory {:.1f} GB/s, {:.1f} on two\n",
             1e-9 * one, 1e-9 * peak, 1e-9 * bandwidth[0], 1e-9 * bandwidth[1]);
  json.begin("machine");
  json.add("fma_peak_1_thread", one);
  json.add("fma_peak_2_threads", peak);
  json.add("read_bandwidth_1_thread", bandwidth[0]);
  json.add("read_bandwidth_2_threads", bandwidth[1]);
  fmt::print(
      "{:<18} {:>8} {:>8} | {:>8} {:>8} {:>8} {:>8} {:>9} {:>9} | {:>3} {:>8} {:>8} {:>9} {:>8} {:>8} | {:>6} "
      "{:>5} | {:>9} {:>9} | {:>8} {:>14}\n",
      "milliseconds", "poses", "edges", "load", "start", "compile", "analyze", "optimize", "total", "its", "linear.",
      "assemble", "factorise", "solve", "rest", "GF/s", "peak", "to 1e-3", "to 1e-6", "MB", "chi2");
  for (const std::string& file : arguments.graphs) {
    const Outcome outcome =
        medianRun(arguments.rounds, [&] { return readGraph(file, registry, {.threads = threads}); });
    report(json, std::filesystem::path(file).stem().string(), outcome, peak);
  }
  using Maker = Graph (*)(int, std::shared_ptr<const Registry>);
  for (const auto& [family, make, largest] :
       {std::tuple<std::string, Maker, int>{"manhattan", bench::manhattanWorld, 1000000},
        std::tuple<std::string, Maker, int>{"sphere", bench::sphereWorld, 100000}}) {
    std::vector<Outcome> worlds;
    for (int poses = 10000; poses <= (quick ? 10000 : largest); poses *= 10) {
      const int rounds = poses > 10000 ? 1 : arguments.rounds;
      worlds.push_back(medianRun(rounds, [&, make = make] { return make(poses, registry); }));
      report(json, fmt::format("{} {}", family, poses), worlds.back(), peak);
    }
    reportGrowth(json, family, worlds);
  }
  json.write(arguments.json);
}
