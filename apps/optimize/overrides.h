#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <quiver/apps/optimize/robust_choice.h>
#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// What a run changes in a graph beside estimates, and takes back at its end, so that flags of one run do not end up in
/// the file it writes.
class Overrides {
 public:
  explicit Overrides(Graph& graph) : graph_(graph) {}

  /// Fixes the vertices of those ids. Throws GraphError if one does not exist.
  void fix(const std::vector<std::int64_t>& ids);
  /// Gives the chosen edges the chosen kernel; no kernel removes what the file says. Returns how many edges that are.
  /// Throws GraphError if a type that is named has none.
  std::int64_t setRobustKernels(const RobustChoice& kernel, const EdgeChoice& edges);
  void takeBack();

 private:
  Graph& graph_;
  std::vector<std::pair<std::int64_t, std::uint64_t>> fixed_;
  /// In the order of Graph::forEachEdge; empty if kernels are untouched.
  std::vector<RobustKernel> kernels_;
};

}  // namespace quiver::app
