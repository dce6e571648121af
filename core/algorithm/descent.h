#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <quiver/core/algorithm/damping_scale.h>
#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/algorithm/options.h>
#include <quiver/core/algorithm/summary.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver {

/// Vectors of a descent, kept for the next one of the same problem.
struct DescentMemory {
  std::vector<double> delta;
  std::array<std::vector<double>, 5> scratch;
  std::optional<DampingScale> scale;
};

/// What the length of a step tells of an optimum where the step brings little.
enum class StepReach {
  full,       ///< what it is by damping alone: an optimum is near
  shortened,  ///< a radius made it short: that is so only if no coordinate could lower the cost by far more either
  held        ///< the memory of DampingScale made it short, which is going to be dropped: nothing
};

/// What Gauss–Newton, Levenberg–Marquardt and dogleg share: the state of a descent, its stopping rules, its report.
///
/// The problem's state is always the estimate kept; the best one met is restored at the end.
class Descent {
 public:
  Descent(Problem& problem, LinearSystem& system, const Options& options, const StopCondition& stop,
          DescentMemory& memory, Summary& summary);

  /// Linearises at the start. False if that is not possible: the status is set.
  bool begin();
  /// Whether trial steps are used up or time is over; sets the status.
  bool exhausted();

  /// Evaluates the trial x ⊞ delta; seconds go to the iteration under way.
  CostTotals tryStep();
  /// Makes the trial the estimate and linearises there. Sets the status and returns true if a stopping rule is met.
  bool accept(const CostTotals& trial);
  /// Reports a rejected trial.
  void reject();
  /// Ends with a status.
  void finish(Status status, std::string_view reason);
  /// Ends since the best step lowers the cost by so little.
  void finishWithoutProspect(double predicted);
  /// Whether the step tried last could do nothing that matters: the cost is next to nothing beside the number of edges,
  /// a full step is next to nothing beside the estimate, or the cost has fallen to what rounding leaves of the first,
  /// and it does not follow its gradient any more. Rounding of constants that errors hold keeps a cost of zero from
  /// being reached and says so nowhere else. Evaluates trials, so whatever was tried is lost.
  bool atRest(bool fullStep);
  /// Whether the last accepted step left the cost as it was, though a single coordinate could lower it: full steps that
  /// leap from one side of a minimum to the other do that.
  bool goesToAndFro(double costBefore) const;
  /// Whether a single coordinate could lower the cost by far more than the tolerance: then a step that was made short
  /// and brought little does not tell of an optimum.
  bool isSteep() const;
  /// Ends there.
  void finishAtRest();
  /// Ends because a linear system could not be solved, in words that name the vertex.
  void fail(const LinearOutcome& outcome);
  /// Ends because the stop condition was met within a linearisation or evaluation.
  void stopMidway();
  /// Goes on from the best estimate met, linearised again, if the present one is worse.
  void returnToBest();
  /// Restores the best estimate.
  void end();

  Problem& problem() { return problem_; }
  LinearSystem& system() { return system_; }
  const CostTotals& totals() const { return totals_; }
  double bestCost() const { return bestTotals_.cost; }
  /// Of the last trial: ‖δ‖/‖x‖.
  double relativeStep() const { return relativeStep_; }
  std::vector<double>& delta() { return memory_.delta; }
  /// Vector 0 … 4 of an algorithm's own, zeros, as long as delta.
  std::vector<double>& scratch(int number);
  DampingScale& dampingScale();
  /// Threads that a loop over delta is worth at the moment.
  int vectorThreads() const;
  const Options& options() const { return options_; }
  const StopCondition& stop() const { return stop_; }
  void setDamping(double damping) { report_.damping = damping_ = damping; }
  /// Of the step under way.
  void setReach(StepReach reach) { reach_ = reach; }
  void setLinearIterations(int iterations) { report_.linearIterations = iterations; }
  bool ended() const { return ended_; }

 private:
  void emitReport(bool accepted);
  void callBack();
  bool stopRuleMet(double costBefore);
  /// Whether the cost is what the rounding of estimates makes of errors that are zero.
  bool costIsRounding() const;
  bool costRests(double costBefore) const;
  /// Whether a little of the way along −D⁻¹g, D = diag(H), the cost falls as its gradient says.
  bool followsGradient();
  /// What rounding of estimates makes of a cost of zero, about: Σ Hᵢᵢ (εx)². O(scalars).
  double roundings() const;
  /// The gradient where the system was linearised last; false, and the end, if it is not finite.
  bool measureGradient();
  std::string describeBadEdge(const CostTotals& totals) const;

  Problem& problem_;
  LinearSystem& system_;
  const Options& options_;
  const StopCondition& stop_;
  DescentMemory& memory_;
  Summary& summary_;
  CostTotals totals_;
  CostTotals bestTotals_;
  bool bestSaved_ = false;
  bool rejected_ = false;
  /// A step was accepted and has no report yet.
  bool unreported_ = false;
  /// ‖g‖∞ at the estimate kept, and the largest |gᵢ|/√Hᵢᵢ, which does not depend on units.
  double gradient_ = 0.0;
  double scaledGradient_ = 0.0;
  double relativeStep_ = 0.0;
  double damping_ = 0.0;
  StepReach reach_ = StepReach::full;
  IterationReport report_;
  Stopwatch watch_;
  bool ended_ = false;
};

/// Full steps of H δ = −g while they work. When `careful`, at most three steps in a row may bring no progress before
/// one leaves the cost above the lowest met: then, or if a step cannot be computed, it returns to the best estimate and
/// returns false without ending the descent: the caller may go on with damping.
bool gaussNewton(Descent& descent, bool careful);

/// Damped steps (H + λ D) δ = −g, D of DampingScale; λ follows the ratio of actual to predicted
/// decrease.
void levenbergMarquardt(Descent& descent);

/// Powell's dogleg: steps of at most a radius in the norm δᵀDδ, D of DampingScale, on the path from
/// the minimum along the scaled gradient to the full step. A smaller radius needs no new factorisation. Where H is not
/// positive definite the full step is that of H + μD, μ as small as serves.
void dogleg(Descent& descent);

}  // namespace quiver
