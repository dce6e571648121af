#pragma once

#include <memory>

#include <quiver/core/algorithm/options.h>
#include <quiver/core/algorithm/summary.h>
#include <quiver/core/graph/graph.h>

namespace quiver {

class Problem;
class StopCondition;

/// Moves the estimates of a graph's free vertices to a minimum of its cost Σ ρ(eᵀΩe), starting from the estimates it
/// has.
///
/// Solvers are found in the graph's registry. On return the graph holds the best estimate met, whatever the status;
/// fixed vertices are unchanged to the last bit. Throws GraphError for options or graphs that make no sense (a vertex
/// without estimate, an unknown solver); numerical outcomes are in the summary. Runs in options.threads threads;
/// distinct graphs may be optimised at the same time.
[[nodiscard]] Summary optimize(Graph& graph, const Options& options = {});

/// `optimize` that keeps what depends on structure alone: the compiled problem, the gauge, the elimination order, all
/// memory.
///
/// A call whose graph has the structure of the last one (the same elements, levels, fixed directions and run-time
/// dimensions; robust kernels or none; zeros at the same places of the information's diagonals; estimates,
/// measurements, other information, kernels and parameter values may differ) starts iterating at once. If estimates
/// alone differ it allocates nothing, once a call has met what it needs; else it finds the gauge anew. Otherwise it
/// compiles anew. The graph must outlive the optimizer's next call. Not thread safe.
class Optimizer {
 public:
  explicit Optimizer(Options options = {});
  ~Optimizer();
  /// What was moved from has default options, knows nothing any more, and may be used again.
  Optimizer(Optimizer&&) noexcept;
  Optimizer& operator=(Optimizer&&) noexcept;

  /// The summary is overwritten by the next call.
  const Summary& optimize(Graph& graph) { return run(graph, true); }
  /// Compiles the graph as the next call of `optimize` does, which then finds it done: to look at chi2 before deciding
  /// where to start, say. The problem holds the estimates the graph has now, and serves until the next call on the
  /// optimizer.
  Problem& compile(Graph& graph);
  /// Whether the last `optimize` reused the structure of the one before.
  bool reused() const;
  /// Applies to the next call; a change of solver or its tolerances, level, subset, gauge or threads compiles anew.
  Options& options();

 private:
  friend Summary optimize(Graph& graph, const Options& options);
  /// `again`: another call may follow, so the structure is kept with what identifies it.
  Summary& run(Graph& graph, bool again);
  /// One descent from the graph's estimates; the summary goes on from what it holds.
  void solve(Graph& graph, bool again, const Options& options, const StopCondition& stop);
  /// False, and the graph is as it was, if a gauge that an earlier call found may be to blame for the outcome.
  bool attempt(Graph& graph, bool again, const Options& options, const StopCondition& stop);

  struct Compiled;
  Options options_;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace quiver
