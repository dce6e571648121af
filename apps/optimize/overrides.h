#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// A kernel as the command line names it: NAME[:WIDTH[:SHAPE]]. Throws UsageError, with the kernels there are.
RobustKernel parseRobustKernel(const std::string& text, const Registry& registry);

/// What a run changes in a graph beside estimates, and takes back at its end, so that flags of one run do not end up in
/// the file it writes.
class Overrides {
 public:
  explicit Overrides(Graph& graph) : graph_(graph) {}

  /// Fixes the vertices of those ids. Throws GraphError if one does not exist.
  void fix(const std::vector<std::int64_t>& ids);
  /// Gives every edge that kernel; no kernel removes what the file says.
  void setRobustKernel(const RobustKernel& kernel);
  void takeBack();

 private:
  Graph& graph_;
  std::vector<std::pair<std::int64_t, std::uint64_t>> fixed_;
  /// In the order of Graph::forEachEdge; empty if kernels are untouched.
  std::vector<RobustKernel> kernels_;
};

}  // namespace quiver::app
