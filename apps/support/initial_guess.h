#pragma once

#include <limits>
#include <string>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// Where an optimisation starts.
struct InitialGuess {
  /// "file", or the initialiser's name.
  std::string name;
  /// A sentence: why this one, or what it did.
  std::string reason;
  /// chi2 of the estimates that were there before; NaN if they were not complete, or are the guess.
  double fileChi2 = std::numeric_limits<double>::quiet_NaN();
};

/// Throws UsageError unless `name` is "file" or an initialiser of the registry.
void checkInitialGuess(const std::string& name, const Registry& registry);

/// Gives every vertex an estimate, or throws GraphError naming the first vertex without one and their number;
/// WorkStopped if the optimizer's options ask to stop before. "auto" is automaticStart(). The optimizer tells the
/// options, and solves next.
InitialGuess makeInitialGuess(Graph& graph, const std::string& name, Optimizer& optimizer);

/// The number of vertices without an estimate.
std::int64_t verticesWithoutEstimate(const Graph& graph);

}  // namespace quiver::app
