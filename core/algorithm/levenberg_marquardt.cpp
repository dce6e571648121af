#include <algorithm>
#include <cmath>

#include <quiver/core/algorithm/descent.h>
#include <quiver/core/util/lane_sums.h>

namespace quiver {
namespace {

/// Bounds of D, as in Ceres: directions that no edge constrains are damped, huge ones do not overflow.
constexpr double leastScale = 1e-6;
constexpr double mostScale = 1e32;
constexpr double leastDamping = 1e-16;
constexpr double mostDamping = 1e16;
/// A step counts if it brings this share of the predicted decrease.
constexpr double acceptedShare = 1e-3;

/// λ by the radius rule: λ shrinks after steps that agree with the model and grows, ever faster, after failures.
class Damping {
 public:
  explicit Damping(double first) : lambda_(first) {}
  double value() const { return lambda_; }
  void succeed(double ratio) {
    const double excess = 2.0 * ratio - 1.0;
    lambda_ = std::max(leastDamping, lambda_ * std::max(1.0 / 3.0, 1.0 - excess * excess * excess));
    growth_ = 2.0;
  }
  void fail() {
    lambda_ *= growth_;
    growth_ *= 2.0;
  }
  bool hopeless() const { return !(lambda_ <= mostDamping); }

 private:
  double lambda_;
  double growth_ = 2.0;
};

}  // namespace

void levenbergMarquardt(Descent& descent) {
  LinearSystem& system = descent.system();
  std::vector<double>& delta = descent.delta();
  std::vector<double>& scaled = descent.scratch(0);
  Damping damping(descent.options().initialDamping);
  int failures = 0;
  while (!descent.exhausted()) {
    const auto diagonal = system.diagonal();
    for (std::size_t i = 0; i < scaled.size(); ++i)
      scaled[i] = damping.value() * std::clamp(diagonal[i], leastScale, mostScale);
    descent.setDamping(damping.value());
    const LinearOutcome outcome = system.solve(scaled, delta, descent.stop());
    if (outcome.kind == LinearOutcome::Kind::interrupted || outcome.kind == LinearOutcome::Kind::memoryLimit)
      return descent.fail(outcome);
    descent.setLinearIterations(outcome.iterations);
    double predicted = 0.0;  // cost(x) − model(δ) = −gᵀδ + δᵀ(λD)δ
    double ratio = -1.0;
    CostTotals trial;
    if (outcome.ok()) {
      const auto gradient = system.gradient();
      predicted =
          sumInLanes(delta.size(), [&](std::size_t i) { return delta[i] * (scaled[i] * delta[i] - gradient[i]); });
      trial = descent.tryStep();
      const double actual = descent.totals().cost - trial.cost;
      ratio = trial.finite() && predicted > 0.0 ? actual / predicted : -1.0;
      // Where the model promises less than rounding can tell, a step that does not raise the cost is as good as the
      // model says.
      if (trial.finite() && predicted <= 1e-13 * descent.totals().cost && actual >= 0.0) ratio = 1.0;
    }
    if (ratio > acceptedShare) {
      damping.succeed(ratio);
      failures = 0;
      if (descent.accept(trial)) return;
      continue;
    }
    descent.reject();
    // A promise made small by damping alone proves nothing: only the first trial from an estimate counts.
    if (failures == 0 && descent.atRest(outcome.ok())) return descent.finishAtRest();
    if (failures++ == 0 && predicted > 0.0 && predicted <= descent.options().costTolerance * descent.totals().cost)
      return descent.finishWithoutProspect(predicted);
    damping.fail();
    if (damping.hopeless()) {
      if (!outcome.ok()) return descent.fail(outcome);
      return descent.finish(
          Status::stalled,
          "no step lowers the cost, however strongly damped; a wrong Jacobian does this: try checkJacobians(graph)");
    }
  }
}

}  // namespace quiver
