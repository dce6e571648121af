#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <quiver/apps/support/graph_source.h>
#include <quiver/core/algorithm/options.h>

namespace quiver::app {

/// What the command line of `quiver optimize` says.
struct OptimizeFlags {
  GraphSource source;
  Dialect dialect = Dialect::g2o;
  std::string output;
  std::string json;
  std::string marginals;
  /// "auto", "gn", "lm", "dogleg", or a name of g2o's.
  std::string algorithm = "auto";
  std::string solver = "auto";
  std::string init = "auto";
  std::string robust;
  std::vector<std::string> robustEdges = {"all"};
  RobustCorrection robustCorrection = RobustCorrection::first;
  GaugePolicy gauge = GaugePolicy::automatic;
  std::vector<std::int64_t> fix;
  std::vector<std::int64_t> only;
  /// If not 0: only vertices of this dimension move.
  int onlyDimension = 0;
  std::vector<std::string> eliminate = {"auto"};
  std::int64_t memoryLimit = 0;
  int iterations = Options().maxIterations;
  double timeLimit = std::numeric_limits<double>::infinity();
  double linearTolerance = Options().linearTolerance;
  bool quiet = false;
};

/// Adds all flags to the command.
void addOptimizeFlags(CLI::App& command, OptimizeFlags& flags);

/// Resolves g2o's solver names, and checks every name against the registry. Throws UsageError with what there is.
void settleNames(OptimizeFlags& flags, const Registry& registry);

/// Sentences about types that --eliminate names and the graph has no vertices of.
std::vector<std::string> idleEliminations(const OptimizeFlags& flags, const Graph& graph);

/// The options of a run, its callbacks and its deadline left to the caller.
Options makeOptions(const OptimizeFlags& flags);

}  // namespace quiver::app
