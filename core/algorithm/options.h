#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <quiver/core/graph/robust_kernel.h>

namespace quiver {

struct IterationReport;

/// What to do about directions in which the whole world may move unnoticed.
enum class GaugePolicy {
  automatic,  ///< Gauss–Newton fixes a vertex per component, damped methods leave the gauge free
  fix,        ///< always fix the vertex of lowest id among those of largest dimension, per component
  free        ///< never fix anything
};

/// Which vertices are eliminated before the rest is solved for (the Schur complement).
enum class EliminationPolicy {
  automatic,  ///< an independent set found from structure, if the predicted cost says so
  none,       ///< none
  types       ///< of the types in `eliminatedTypes`, as many as no edge joins to each other
};

/// What `optimize` does. An aggregate: fields are only ever appended.
struct Options {
  /// Trial steps at most.
  int maxIterations = 100;
  /// "auto", "gn", "lm" or "dogleg".
  std::string algorithm = "auto";
  /// "auto" or a linear solver's name in the registry: "block", "dense", "eigen", "cholmod", …
  std::string linearSolver = "auto";
  GaugePolicy gauge = GaugePolicy::automatic;
  /// Threads at most; 0 means as many as the machine has. Results do not depend on it.
  int threads = 0;
  /// Seconds; honoured inside an iteration. The best estimate so far is kept.
  double timeLimit = std::numeric_limits<double>::infinity();
  std::stop_token stopToken = {};
  /// Stop when |Δcost| / cost of an accepted step is below this, or when the cost is what rounding makes of errors that
  /// are zero. This rule and the next two are switched off by 0.
  double costTolerance = 1e-10;
  /// Stop when the largest |gᵢ|/√Hᵢᵢ is below this part of √cost: when no column of the Jacobian makes a larger cosine
  /// with the residual, whatever the units.
  double gradientTolerance = 1e-10;
  /// Stop when ‖Δ‖ / (‖x‖ + 1e-10) of a full step is below this and the cost falls no more: far from the origin, and
  /// for robust kernels whose weights settle slowly, short steps alone prove nothing. With a `costTolerance` of 0 they
  /// do.
  double stepTolerance = 1e-10;
  /// Edges of this level take part; −1 means all edges.
  int level = 0;
  /// If not empty: only these vertices move, all others are held, and only edges on these take part.
  std::vector<std::int64_t> free = {};
  /// First damping of Levenberg–Marquardt, relative to the diagonal of H; positive and finite.
  double initialDamping = 1e-4;
  /// Called after every trial step, on the calling thread. It must leave the graph alone: GraphError if it adds,
  /// removes or changes elements; estimates it sets are overwritten. What it throws ends the solve; the estimate so far
  /// is kept.
  std::function<void(const IterationReport&)> callback = {};

  /// How robust kernels enter H.
  RobustCorrection robustCorrection = RobustCorrection::first;
  /// Iterative linear solvers end where the residual is this part of the right-hand side, in the norm of their
  /// preconditioner; they may begin looser and tighten as the gradient falls.
  double linearTolerance = 1e-8;
  /// Iterations of an iterative linear solver at most; 0 means ten times the unknown scalars, at most 10000.
  int maxLinearIterations = 0;
  /// Called when a long phase of the work begins, with a few words that name it ("analysing the structure"), on the
  /// calling thread. It must leave the graph alone like `callback`.
  std::function<void(std::string_view)> phase = {};

  EliminationPolicy elimination = EliminationPolicy::automatic;
  /// Tags of vertex types, for EliminationPolicy::types.
  std::vector<std::string> eliminatedTypes = {};
  /// Bytes that a solve may take beside the graph; 0 means no limit. A solve predicted to take more ends with
  /// Status::memoryLimit before it allocates.
  std::int64_t memoryLimit = 0;

  /// Throws GraphError naming the first option that makes no sense.
  void validate() const;
};

}  // namespace quiver
