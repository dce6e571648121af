#pragma once

#include <memory>
#include <optional>
#include <span>

#include <quiver/core/algorithm/summary.h>
#include <quiver/core/problem/state.h>
#include <quiver/core/util/stop_condition.h>

namespace quiver {

class Problem;
struct Options;

/// How a solve ended; `variable` counts the problem's variables.
struct LinearOutcome {
  /// notConverged: an iteration reached its limit, and what it had is the step.
  enum class Kind { success, notPositiveDefinite, notConverged, interrupted, memoryLimit };
  Kind kind = Kind::success;
  /// Where the first pivot was not positive; −1 if nowhere.
  int variable = -1;
  int coordinate = -1;
  double pivot = 0.0;
  int iterations = 0;

  bool ok() const { return kind == Kind::success; }
  /// Whether there is a step: the solution, or one on the way to it.
  bool hasStep() const { return ok() || kind == Kind::notConverged; }
};

/// Totals over all edges at one state.
struct CostTotals {
  double chi2 = 0.0;
  double cost = 0.0;
  /// Batch and edge of the first one that is not finite; −1 if all are.
  int badBatch = -1;
  int badEdge = -1;

  bool finite() const { return badBatch < 0; }
  /// Adds the totals of edges that come later.
  void add(const CostTotals& later) {
    chi2 += later.chi2;
    cost += later.cost;
    if (badBatch >= 0) return;
    badBatch = later.badBatch;
    badEdge = later.badEdge;
  }
};

/// The only door from algorithms to solvers: structure once, numbers per iteration.
///
/// All vectors are in the order of the problem's variables. H = Σ JᵀJ and g = Σ Jᵀr with the panels' J and r, so the
/// step of Gauss–Newton solves H δ = −g. Damping is an argument of `solve`, not a change to H. Not thread safe.
class LinearSystem {
 public:
  virtual ~LinearSystem() = default;

  /// Whether `analyze` would eliminate vertices of this problem beforehand. Pure; a fraction of the analysis.
  virtual bool eliminates(const Problem&, const Options&) const { return false; }

  /// Decides ordering, elimination and layout for a problem; `problem` must outlive the system's use. Fills the plan.
  virtual void analyze(const Problem& problem, const Options& options, int threads) = 0;

  /// Another descent begins with the same structure: what depends on earlier gradients is forgotten.
  virtual void restart() {}

  /// Computes H and g at a state, and the totals there.
  virtual CostTotals linearize(const State& state) = 0;

  /// Linearises at a trial, for a system that does so at once, since `linearize` at the same state, unchanged, then
  /// costs nothing. Until then, or until `dropTrial`, H and g are nobody's. Nothing for a system that does not.
  virtual std::optional<CostTotals> tryState(const State&) { return std::nullopt; }
  /// The trial is not taken: H and g are those of the last `linearize` again, whose state is unchanged.
  virtual void dropTrial() {}

  /// delta = −(H + diag(damping))⁻¹ g; `damping` has an entry ≥ 0 for every scalar, or is empty.
  virtual LinearOutcome solve(std::span<const double> damping, std::span<double> delta, const StopCondition& stop) = 0;

  /// delta = −H'⁻¹ g with the factor that `solve` made last, of an earlier H' (and its damping), and the gradient of
  /// now: a chord step, far cheaper than a factorisation. The default factors anew.
  virtual LinearOutcome solveWithLastFactor(std::span<double> delta, const StopCondition& stop) {
    return solve({}, delta, stop);
  }

  /// Overwrites b with H'⁻¹ b by that factor; false if the system offers no such thing or has no factor.
  virtual bool applyInverse(std::span<double> b) {
    (void)b;
    return false;
  }

  /// g and diag(H) of the last linearisation.
  virtual std::span<const double> gradient() const = 0;
  virtual std::span<const double> diagonal() const = 0;
  /// y = H x. O(nonzeros of H).
  virtual void multiply(std::span<const double> x, std::span<double> y) const = 0;

  virtual const SolvePlan& plan() const = 0;
  /// Adds the seconds spent in linearize and solve since the last call to `seconds`.
  virtual void addSeconds(PhaseSeconds& seconds) = 0;
};

}  // namespace quiver
