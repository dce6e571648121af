#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include <quiver/core/algorithm/damping_scale.h>
#include <quiver/core/algorithm/descent.h>
#include <quiver/core/algorithm/short_steps.h>
#include <quiver/core/util/lane_sums.h>
#include <quiver/core/util/pieces.h>

namespace quiver {
namespace {

constexpr double leastDamping = 1e-16;
constexpr double mostDamping = 1e16;
/// A step counts if it brings this share of the predicted decrease.
constexpr double acceptedShare = 1e-3;
/// By so much D may exceed H before its memory is dropped where it holds a step that promises next to nothing: H has
/// fallen by many powers of ten at once, and λ D is far above it though λ is small.
constexpr double mostExcess = 1e3;

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

/// cost(x) − model(δ) = −gᵀδ + δᵀ(λD)δ.
double predictedDecrease(std::span<const double> delta, std::span<const double> gradient,
                         std::span<const double> damping, int threads) {
  const auto part = [&](std::size_t begin, std::size_t end) {
    const double* const step = delta.data() + begin;
    const double* const damped = damping.data() + begin;
    const double* const slope = gradient.data() + begin;
    return sumInLanes(end - begin, [&](std::size_t i) { return step[i] * (damped[i] * step[i] - slope[i]); });
  };
  return overPieces(delta.size(), threads, part, std::plus<>());
}

}  // namespace

void levenbergMarquardt(Descent& descent) {
  LinearSystem& system = descent.system();
  std::vector<double>& delta = descent.delta();
  std::vector<double>& scaled = descent.scratch(0);
  Damping damping(descent.options().initialDamping);
  DampingScale& scale = descent.dampingScale();
  scale.restart();
  scale.update(system.diagonal());
  int failures = 0;
  while (!descent.exhausted()) {
    scale.scale(damping.value(), descent.vectorThreads(), scaled);
    descent.setDamping(damping.value());
    const bool held = scale.excess() > mostExcess && damping.value() * scale.excess() > 1.0;
    descent.setReach(held ? StepReach::held : StepReach::full);
    const LinearOutcome outcome = system.solve(scaled, delta, descent.stop());
    if (outcome.kind == LinearOutcome::Kind::interrupted || outcome.kind == LinearOutcome::Kind::memoryLimit)
      return descent.fail(outcome);
    descent.setLinearIterations(outcome.iterations);
    double predicted = 0.0;
    double ratio = -1.0;
    CostTotals trial;
    // What conjugate gradients had at their limit lowers the model too, by as much as the formula says.
    if (outcome.hasStep()) {
      predicted = predictedDecrease(delta, system.gradient(), scaled, descent.vectorThreads());
      trial = descent.tryStep();
      const double actual = descent.totals().cost - trial.cost;
      ratio = trial.finite() && predicted > 0.0 ? actual / predicted : -1.0;
      // Where the model promises less than rounding can tell, a step that does not raise the cost is as good as the
      // model says.
      if (trial.finite() && predicted <= 1e-13 * descent.totals().cost && actual >= 0.0) ratio = 1.0;
    }
    const bool little = predicted > 0.0 && predicted <= descent.options().costTolerance * descent.totals().cost;
    if (ratio > acceptedShare) {
      damping.succeed(ratio);
      failures = 0;
      if (descent.accept(trial)) return;
      if (held && little) scale.restart();
      scale.update(system.diagonal(), ratio);
      continue;
    }
    descent.reject();
    if (held && little) {
      scale.restart();
      scale.update(system.diagonal());
      continue;
    }
    // A promise made small by damping alone proves nothing: only the first trial from an estimate counts.
    if (failures == 0 && descent.atRest(outcome.ok())) return descent.finishAtRest();
    if (failures++ == 0 && little && damping.value() <= detail::mostTellingDamping)
      return descent.finishWithoutProspect(predicted);
    damping.fail();
    if (damping.hopeless()) {
      if (!outcome.ok()) return descent.fail(outcome);
      return descent.finish(Status::stalled, detail::stalledReason);
    }
  }
}

}  // namespace quiver
