// Sparse Cholesky against CHOLMOD on the Hessians of pose graphs: same matrices, same run, interleaved.
//
//   quiver_bench_factorization [--json FILE] [--rounds N] [--any-blas] [GRAPH.g2o...]
//
// Without graphs: those of the folder QUIVER_DATA (or ../shared/data) and a simulated one. CHOLMOD is the fastest of
// minimum degree and METIS, supernodal and simplicial, one BLAS thread. Times are medians; ratios are medians of the
// rounds' ratios.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/util/error.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/block/factor_pattern.h>

#include "factorization/cholmod_reference.h"
#include "factorization/graph_patterns.h"
#include "factorization/machine_peak.h"
#include "peers/blas.h"

namespace quiver::bench {
namespace {

using Clock = std::chrono::steady_clock;

double millisecondsOf(const std::function<void()>& work) {
  const auto begin = Clock::now();
  work();
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

double medianOf(int rounds, const std::function<void()>& work) {
  std::vector<double> times;
  for (int i = 0; i < rounds; ++i) times.push_back(millisecondsOf(work));
  return median(times);
}

struct Row {
  std::string graph, ordering, cholmodMethod;
  int blocks = 0;
  std::int64_t nonzeros = 0;
  double megaflops = 0.0, orderMs = 0.0, amdMs = 0.0, analyzeMs = 0.0;
  double cholmodMs = 0.0, cholmodSolveMs = 0.0;
  double factorMs[2] = {0.0, 0.0}, solveMs[2] = {0.0, 0.0}, ratio[2] = {0.0, 0.0}, peakShare[2] = {0.0, 0.0};
  // What solving adds to a factorisation when both are asked for at once, as a share of it.
  double addedShare[2] = {0.0, 0.0};
  double residual = 0.0;
};

struct Opponent {
  std::string name;
  BlockMatrix matrix;
  CholmodReference solver;
  double ms;
};

/// The fastest way CHOLMOD has for the pattern.
Opponent fastestCholmod(const BlockPattern& pattern) {
  std::vector<Opponent> all;
  std::vector<BlockOrdering> orderings{amdOrdering(pattern)};
  if (hasMetis()) orderings.push_back(metisOrdering(pattern));
  for (const BlockOrdering& ordering : orderings) {
    const BlockMatrix matrix = dominantValues(std::make_shared<const BlockPattern>(pattern.permuted(ordering.order)));
    for (const bool supernodal : {true, false}) {
      Opponent opponent{
          ordering.name + (supernodal ? " supernodal" : " simplicial"), matrix, {matrix, supernodal}, 0.0};
      opponent.solver.factorize();
      opponent.ms = medianOf(5, [&] { opponent.solver.factorize(); });
      all.push_back(std::move(opponent));
    }
  }
  return std::move(*std::ranges::min_element(all, {}, &Opponent::ms));
}

double relativeResidual(const BlockMatrix& matrix, const std::vector<double>& b, const std::vector<double>& x) {
  std::vector<double> product(b.size());
  matrix.multiply(x, product);
  double error = 0.0;
  double scale = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    error += (product[i] - b[i]) * (product[i] - b[i]);
    scale += b[i] * b[i];
  }
  return std::sqrt(error / scale);
}

/// The median over pairs of factorizeAndSolve and factorize alone.
double addedShare(LinearSolver& solver, const BlockMatrix& matrix, const std::vector<double>& b) {
  std::vector<double> x;
  std::vector<double> shares;
  for (int round = 0; round < 21; ++round) {
    const double alone = medianOf(3, [&] { solver.factorize(matrix, {}); });
    const double both = medianOf(3, [&] {
      x = b;
      solver.factorizeAndSolve(matrix, {}, x);
    });
    shares.push_back(both / alone - 1.0);
  }
  return median(shares);
}

Row measure(const GraphPattern& graph, int rounds, const double (&peak)[2]) {
  Row row;
  row.graph = graph.name;
  row.blocks = graph.pattern.blocks();
  std::unique_ptr<LinearSolver> solvers[2] = {makeBlockSolver(), makeBlockSolver()};
  BlockOrdering ordering;
  row.orderMs = medianOf(5, [&] { ordering = solvers[0]->order(graph.pattern); });
  row.ordering = ordering.name;
  const auto pattern = std::make_shared<const BlockPattern>(graph.pattern.permuted(ordering.order));
  const BlockMatrix matrix = dominantValues(pattern);
  std::vector<double> amd, analyze;
  for (int turn = 0; turn < 15; ++turn) {
    amd.push_back(medianOf(1, [&] { amdOrdering(graph.pattern); }));
    analyze.push_back(medianOf(1, [&] {
      solvers[0] = makeBlockSolver();  // one that had the pattern before would keep its analysis
      solvers[0]->analyze(pattern, 1);
    }));
  }
  row.amdMs = median(amd);
  row.analyzeMs = median(analyze);
  solvers[1]->analyze(pattern, 2);
  row.nonzeros = solvers[0]->statistics().nonzeros;
  row.megaflops = solvers[0]->statistics().flops * 1e-6;
  Opponent cholmod = fastestCholmod(graph.pattern);
  row.cholmodMethod = cholmod.name;
  std::vector<double> reference;
  std::vector<double> times[2];
  std::vector<double> ratios[2];
  const int inner = std::max(1, static_cast<int>(2.0 / cholmod.ms));
  for (int round = -2; round < rounds; ++round) {  // two rounds to warm up
    const double opponent = medianOf(inner, [&] { cholmod.solver.factorize(); });
    for (int t = 0; t < 2; ++t) {
      const double ms = medianOf(2 * inner + 1, [&] { solvers[t]->factorize(matrix, {}); });
      if (round < 0) continue;
      times[t].push_back(ms);
      ratios[t].push_back(opponent / ms);
    }
    if (round >= 0) reference.push_back(opponent);
  }
  row.cholmodMs = median(reference);
  const std::vector<double> b(static_cast<std::size_t>(pattern->layout().scalars()), 1.0);
  std::vector<double> x = b;
  row.cholmodSolveMs = medianOf(9, [&] { cholmod.solver.solve(x.data()); });
  for (int t = 0; t < 2; ++t) {
    row.factorMs[t] = median(times[t]);
    row.ratio[t] = median(ratios[t]);
    row.peakShare[t] = row.megaflops * 1e6 / (row.factorMs[t] * 1e-3) / peak[t];
    row.solveMs[t] = medianOf(15, [&] {
      x = b;
      solvers[t]->solve(x);
    });
    row.residual = std::max(row.residual, relativeResidual(matrix, b, x));
    row.addedShare[t] = addedShare(*solvers[t], matrix, b);
  }
  return row;
}

void print(const Row& r) {
  fmt::print(
      "{:<16} {:>6} {:>9} {:>8.1f} {:<6} | {:>8.3f} {:<16} | {:>8.3f} {:>5.1f} {:>5.1f}x {:>4.0f}% | {:>8.3f} {:>5.1f} "
      "{:>5.1f}x {:>4.0f}% | "
      "{:>6.2f} {:>6.2f} {:>6.2f} | {:>6.3f} {:>6.3f} {:>6.3f} | {:>4.0f}% {:>4.0f}% | {:.0e}\n",
      r.graph, r.blocks, r.nonzeros, r.megaflops, r.ordering, r.cholmodMs, r.cholmodMethod, r.factorMs[0],
      r.megaflops / r.factorMs[0], r.ratio[0], 100 * r.peakShare[0], r.factorMs[1], r.megaflops / r.factorMs[1],
      r.ratio[1], 100 * r.peakShare[1], r.amdMs, r.orderMs, r.analyzeMs, r.solveMs[0], r.solveMs[1], r.cholmodSolveMs,
      100 * r.addedShare[0], 100 * r.addedShare[1], r.residual);
  std::cout.flush();
}

void writeJson(const std::string& path, const std::vector<Row>& rows, const double (&peak)[2], const Blas& blas) {
  std::ofstream file(path);
  if (!file) throw FileError(path + ": cannot be written");
  file << fmt::format("{{\"peak_gflops\": [{:.2f}, {:.2f}], \"blas\": \"{}\", \"graphs\": [", peak[0] * 1e-9,
                      peak[1] * 1e-9, blas.name);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    file << fmt::format(
        "{}\n {{\"graph\": \"{}\", \"blocks\": {}, \"nonzeros\": {}, \"megaflops\": {:.3f}, \"ordering\": \"{}\", "
        "\"cholmod_method\": \"{}\", "
        "\"cholmod_ms\": {:.4f}, \"cholmod_solve_ms\": {:.4f}, \"factor_ms\": [{:.4f}, {:.4f}], \"ratio\": [{:.3f}, "
        "{:.3f}], "
        "\"peak_share\": [{:.4f}, {:.4f}], \"amd_ms\": {:.3f}, \"order_ms\": {:.3f}, \"analyze_ms\": {:.3f}, "
        "\"solve_ms\": [{:.4f}, {:.4f}], \"solve_added_share\": [{:.4f}, {:.4f}], "
        "\"residual\": {:.2e}}}",
        i == 0 ? "" : ",", r.graph, r.blocks, r.nonzeros, r.megaflops, r.ordering, r.cholmodMethod, r.cholmodMs,
        r.cholmodSolveMs, r.factorMs[0], r.factorMs[1], r.ratio[0], r.ratio[1], r.peakShare[0], r.peakShare[1], r.amdMs,
        r.orderMs, r.analyzeMs, r.solveMs[0], r.solveMs[1], r.addedShare[0], r.addedShare[1], r.residual);
  }
  file << "\n]}\n";
}

struct Arguments {
  std::string json;
  int rounds = 15;
  bool anyBlas = false;
  std::vector<std::string> graphs;
};

/// `--benchmark_out=FILE` is what scripts/bench calls the JSON file; other --benchmark_ options have no meaning here.
Arguments parse(int count, char** words) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--json" && i + 1 < count) {
      arguments.json = words[++i];
    } else if (word.rfind("--benchmark_out=", 0) == 0) {
      arguments.json = word.substr(word.find('=') + 1);
    } else if (word == "--rounds" && i + 1 < count) {
      arguments.rounds = std::max(1, std::atoi(words[++i]));
    } else if (word == "--any-blas") {
      arguments.anyBlas = true;
    } else if (word.rfind("--benchmark_", 0) != 0) {
      arguments.graphs.push_back(word);
    }
  }
  return arguments;
}

int run(const Arguments& arguments) {
  const Blas blas = demandBlas(arguments.anyBlas);
  std::vector<GraphPattern> graphs;
  for (const std::string& path : arguments.graphs) graphs.push_back(readGraphPattern(path));
  if (graphs.empty()) {
    const char* folder = std::getenv("QUIVER_DATA");
    const std::filesystem::path data = folder != nullptr ? folder : "../shared/data";
    for (const char* name :
         {"sphere_noisy", "sphere2500", "torus3D", "parking-garage", "M3500", "intel", "MIT", "manhattan"}) {
      const std::filesystem::path path = data / (std::string(name) + ".g2o");
      if (std::filesystem::exists(path)) graphs.push_back(readGraphPattern(path.string()));
    }
    graphs.push_back(simulateManhattan(10000));
  }
  const double peak[2] = {fmaPeak(1), fmaPeak(2)};
  fmt::print("FMA peak {:.1f} GFlop/s on one thread, {:.1f} on two\n", peak[0] * 1e-9, peak[1] * 1e-9);
  fmt::print(
      "{:<16} {:>6} {:>9} {:>8} {:<6} | {:>8} {:<16} | {:>8} {:>5} {:>6} {:>5} | {:>8} {:>5} {:>6} {:>5} | {:>6} {:>6} "
      "{:>6} | {:>6} "
      "{:>6} {:>6} | {:>5} {:>5} | {}\n",
      "graph", "blocks", "nnz(L)", "MFlop", "order", "CHOLMOD", "ms, fastest of", "1 thr ms", "GF/s", "ratio", "peak",
      "2 thr ms", "GF/s", "ratio", "peak", "amd", "order", "anlyze", "solve1", "solve2", "cholm.", "adds1", "adds2",
      "residual");
  std::vector<Row> rows;
  for (const GraphPattern& graph : graphs) {
    rows.push_back(measure(graph, arguments.rounds, peak));
    print(rows.back());
  }
  if (!arguments.json.empty()) writeJson(arguments.json, rows, peak, blas);
  return 0;
}

}  // namespace
}  // namespace quiver::bench

int main(int count, char** words) {
  try {
    return quiver::bench::run(quiver::bench::parse(count, words));
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
