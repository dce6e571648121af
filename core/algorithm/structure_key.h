#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

/// Everything that a compiled problem and its linear system depend on besides numbers: two equal keys mean that what
/// was compiled for one serves the other. Which elements there are, the graph's stamp and their numbers tell; what can
/// change of them, fixed directions, run-time dimensions, levels, whether there is an estimate and whether any robust
/// kernel, which entries of a measurement have no weight (the gauge depends on that), enters by a 128-bit hash.
class StructureKey {
 public:
  StructureKey() = default;
  /// O(vertices + edges); O(1) with the key of the same graph from when it had the revision it has now.
  StructureKey(const Graph& graph, const Options& options, int threads, const StructureKey* before = nullptr);

  /// Whether it is of what is at this address now, changed or not.
  bool isOf(const Graph& graph) const { return graph_ == &graph && stamp_ == graph.stamp(); }

  bool operator==(const StructureKey&) const = default;

 private:
  const Graph* graph_ = nullptr;
  std::pair<std::int64_t, std::int64_t> stamp_;
  std::int64_t vertices_ = 0;
  std::int64_t edges_ = 0;
  std::uint64_t hash_[2] = {0, 0};
  int threads_ = 0;
  int level_ = 0;
  GaugePolicy gauge_ = GaugePolicy::automatic;
  std::string solver_;
  std::string algorithm_;
  std::vector<std::int64_t> free_;
  EliminationPolicy elimination_ = EliminationPolicy::automatic;
  std::vector<std::string> eliminatedTypes_;
  std::int64_t memoryLimit_ = 0;
  double linearTolerance_ = 0.0;
  int maxLinearIterations_ = 0;
};

}  // namespace quiver
