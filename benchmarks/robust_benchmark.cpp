// What wrong loop closures do to a trajectory, with kernels and without.
//
//   quiver simulate outliers M3500.g2o -o wrong.g2o --fraction 0.1 --seed 1
//   quiver_bench_robust M3500.g2o wrong.g2o...
//
// The first graph is without wrong loop closures, the others are the same with some. Each starts from odometry and is
// optimised with a kernel on its loop closures. Printed is the absolute trajectory error in metres: from the truth
// where the world is a lattice and the truth therefore known, else from the optimum of the first graph.

#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/util/stopwatch.h>

#include "robust_trajectories.h"

namespace quiver {
namespace {

struct Choice {
  const char* name;
  RobustKernel kernel;
};

bool isLoop(const Edge& edge) { return edge.arity() == 2 && std::abs(edge.vertexId(0) - edge.vertexId(1)) != 1; }

/// The graph from odometry with the kernel on its loop closures, optimised.
Summary solve(Graph& graph, const RobustKernel& kernel) {
  Options options;
  options.maxIterations = 300;
  (void)odometryEstimate(graph, options);
  graph.forEachEdge([&](Edge& edge) {
    if (isLoop(edge)) edge.setRobustKernel(kernel);
  });
  return optimize(graph, options);
}

void measure(const std::string& path, const std::vector<std::string>& wrong) {
  const auto registry = builtinRegistry();
  const Graph original = readGraph(path, registry);
  Graph clean(original);
  (void)automaticStart(clean, {});
  (void)optimize(clean);
  double worst = 1.0;
  Eigen::MatrixXd truth = positionsOf(clean);
  if (truth.rows() == 2) {
    const Eigen::MatrixXd lattice = latticeTruth(original, worst);
    if (worst < 0.2 && lattice.cols() == truth.cols()) truth = lattice;
  }
  const double best = trajectoryError(positionsOf(clean), truth);
  fmt::print("{}: error of the clean optimum {:.4f} m from {}\n", path, best,
             worst < 0.2 ? "the true lattice" : "itself");
  const Choice choices[] = {{"none", RobustKernel()},
                            {"dcs:1", RobustKernelDCS(1.0)},
                            {"dcs:3", RobustKernelDCS(3.0)},
                            {"gemanmcclure:1", RobustKernelGemanMcClure(1.0)},
                            {"gemanmcclure:4", RobustKernelGemanMcClure(4.0)}};
  fmt::print("{:<15}  {:>10}  {:>8}  {:>6}  {:>8}  {}\n", "kernel", "error [m]", best > 1e-9 ? "to clean" : "", "steps",
             "ms", "status");
  for (const std::string& name : wrong) {
    const Graph spoilt = readGraph(name, registry);
    fmt::print("{}: {} more edges\n", name, spoilt.edgeCount() - original.edgeCount());
    for (const Choice& choice : choices) {
      Graph graph(spoilt);
      const Stopwatch watch;
      const Summary summary = solve(graph, choice.kernel);
      const double error = trajectoryError(positionsOf(graph), truth);
      fmt::print("{:<15}  {:>10.4f}  {:>8}  {:>6}  {:>8.0f}  {}\n", choice.name, error,
                 best > 1e-9 ? fmt::format("{:.3f}", error / best) : "", summary.iterations.size(),
                 1e3 * watch.seconds(), toString(summary.status));
      std::fflush(stdout);
    }
  }
}

}  // namespace
}  // namespace quiver

int main(int count, char** words) {
  if (count < 3) {
    fmt::print(stderr, "usage: quiver_bench_robust CLEAN WRONG...\n");
    return 2;
  }
  try {
    quiver::measure(words[1], {words + 2, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
