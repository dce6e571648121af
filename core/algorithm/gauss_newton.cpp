#include <algorithm>
#include <cmath>
#include <string_view>

#include <quiver/core/algorithm/descent.h>
#include <quiver/core/util/lane_sums.h>

namespace quiver {

namespace {

/// Once a step changed the cost by less than this of itself, H hardly changes any more and its last factor serves on.
constexpr double chordChange = 1e-6;
/// After so many steps in a row without progress, none may leave the cost above the lowest met: a full step far from
/// the optimum often overshoots and still leads to where the next ones converge.
constexpr int mostDetours = 3;
/// Progress: the lowest cost falls by this share of what the step promised. Steps that leap from one side of a valley
/// to the other promise much and bring next to nothing.
constexpr double leastProgress = 0.1;
/// A step so many times as long as the estimate leaps out of the basin of the start; if it gains nothing there, what
/// lies beyond may be a minimum at infinity.
constexpr double leap = 10.0;
/// Of a cost: what no step can be seen to lower it by.
constexpr double rounding = 1e-15;

/// Full steps do not work: others may go on from the best estimate (false), or it ends here.
bool giveUp(Descent& descent, bool careful, std::string_view reason) {
  if (careful) {
    descent.returnToBest();
    return false;
  }
  descent.finish(Status::stalled, reason);
  return true;
}

}  // namespace

bool gaussNewton(Descent& descent, bool careful) {
  bool chord = false;
  int detours = 0;
  while (!descent.exhausted()) {
    const LinearOutcome outcome = chord ? descent.system().solveWithLastFactor(descent.delta(), descent.stop())
                                        : descent.system().solve({}, descent.delta(), descent.stop());
    if (outcome.kind == LinearOutcome::Kind::interrupted) {
      descent.fail(outcome);
      return true;
    }
    if (!outcome.ok()) {
      if (careful) {
        descent.returnToBest();
        return false;
      }
      descent.fail(outcome);
      return true;
    }
    descent.setLinearIterations(outcome.iterations);
    const double before = descent.totals().cost;
    // −gᵀδ, what the model promises: less than rounding can tell is the end.
    const auto gradient = descent.system().gradient();
    const std::vector<double>& delta = descent.delta();
    const double predicted = -sumInLanes(delta.size(), [&](std::size_t i) { return gradient[i] * delta[i]; });
    if (descent.options().costTolerance > 0.0 && predicted >= 0.0 && predicted <= rounding * before) {
      descent.finishWithoutProspect(predicted);
      return true;
    }
    const double lowest = descent.bestCost();
    const CostTotals trial = descent.tryStep();
    const bool rises = !(trial.cost <= before * (1.0 + 1e-9));
    const bool above = !(trial.cost <= lowest * (1.0 + 1e-9));
    const bool leaps = above && descent.relativeStep() > leap;
    const bool works = trial.finite() && !(chord && rises) && !(careful && above && (detours >= mostDetours || leaps));
    if (!works) {
      descent.reject();
      if (chord) {
        chord = false;
        continue;
      }
      if (descent.atRest(true)) {
        descent.finishAtRest();
        return true;
      }
      return giveUp(descent, careful, "a full step leads to errors that are not finite; try --algorithm lm");
    }
    if (descent.accept(trial)) return true;
    const bool idle = descent.goesToAndFro(before);
    const bool progress = !idle && lowest - trial.cost >= leastProgress * std::max(predicted, 0.0);
    detours = progress ? 0 : detours + 1;
    if (idle && detours > mostDetours)
      return giveUp(descent, careful, "full steps go to and fro and leave the cost as it is; try --algorithm lm");
    chord = std::abs(before - trial.cost) <= chordChange * before;
  }
  return true;
}

}  // namespace quiver
