#include <cmath>

#include <fmt/format.h>

#include <quiver/core/algorithm/descent.h>

namespace quiver {

bool gaussNewton(Descent& descent, bool careful) {
  while (!descent.exhausted()) {
    const LinearOutcome outcome = descent.system().solve({}, descent.delta(), descent.stop());
    if (outcome.kind == LinearOutcome::Kind::interrupted) {
      descent.fail(outcome);
      return true;
    }
    if (!outcome.ok()) {
      if (careful) return false;
      descent.fail(outcome);
      return true;
    }
    descent.setLinearIterations(outcome.iterations);
    const CostTotals trial = descent.tryStep();
    const bool works = trial.finite() && (!careful || trial.cost <= descent.totals().cost * (1.0 + 1e-9));
    if (!works) {
      descent.reject();
      if (careful) return false;
      descent.finish(Status::stalled, "a full step leads to errors that are not finite; try --algorithm lm");
      return true;
    }
    if (descent.accept(trial)) return true;
  }
  return true;
}

}  // namespace quiver
