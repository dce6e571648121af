#include <algorithm>
#include <cmath>
#include <limits>

#include <quiver/core/algorithm/damping_scale.h>
#include <quiver/core/algorithm/descent.h>
#include <quiver/core/algorithm/short_steps.h>

namespace quiver {
namespace {

/// A step counts if it brings this share of the predicted decrease.
constexpr double acceptedShare = 1e-3;
/// Where H is not positive definite, H + μD is factored, μ from the least to the most of these.
constexpr double leastRegularization = 1e-10;
constexpr double mostRegularization = 1.0;
/// A radius so much smaller than the full step allows no motion that rounding would notice.
constexpr double leastRadius = 1e-16;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The two steps between which the trust region chooses, at one linearisation: the minimum along the scaled gradient,
/// and the full step. Lengths are measured by ‖δ‖² = δᵀDδ, D = diag(H) bounded, so that metres and radians need no
/// common unit.
class DoglegPath {
 public:
  explicit DoglegPath(Descent& descent)
      : scale_(descent.scratch(0)),
        cauchy_(descent.scratch(1)),
        full_(descent.scratch(2)),
        product_(descent.scratch(3)),
        damping_(descent.scratch(4)) {
    descent.dampingScale().restart();
  }

  /// Computes both steps after one that brought `ratio` of its promise; factors once, again only where H is not
  /// positive definite.
  LinearOutcome compute(Descent& descent, double ratio) {
    LinearSystem& system = descent.system();
    descent.dampingScale().update(system.diagonal(), ratio);
    descent.dampingScale().scale(1.0, descent.vectorThreads(), scale_);
    const auto gradient = system.gradient();
    for (std::size_t i = 0; i < cauchy_.size(); ++i) cauchy_[i] = -gradient[i] / scale_[i];
    system.multiply(cauchy_, product_);
    const double curvature = dot(cauchy_, product_);
    const double length = curvature > 0.0 ? -dot(cauchy_, gradient) / curvature : 1.0;
    for (double& value : cauchy_) value *= length;
    cauchyNorm_ = norm(cauchy_);
    const LinearOutcome outcome = solveFull(descent);
    fullNorm_ = outcome.ok() ? norm(full_) : 0.0;
    fullPromise_ = -dot(gradient, full_);
    return outcome;
  }

  /// The point of the path cauchy → full whose length is `radius`, or the end where the path is shorter.
  void stepOfLength(double radius, std::span<double> delta) const {
    if (fullNorm_ <= radius) {
      std::copy(full_.begin(), full_.end(), delta.begin());
      return;
    }
    double toCauchy = radius / cauchyNorm_;
    double toFull = 0.0;
    if (cauchyNorm_ < radius) {
      // ‖c + t(f − c)‖² = radius², a quadratic in t with one positive root.
      const double mixed = scaledDot(cauchy_, full_);
      const double a = fullNorm_ * fullNorm_ - 2.0 * mixed + cauchyNorm_ * cauchyNorm_;
      const double b = mixed - cauchyNorm_ * cauchyNorm_;
      const double c = (cauchyNorm_ - radius) * (cauchyNorm_ + radius);
      const double root = std::sqrt(std::max(0.0, b * b - a * c));
      toFull = b > 0.0 ? -c / (b + root) : (root - b) / a;
      toCauchy = 1.0 - toFull;
    }
    for (std::size_t i = 0; i < delta.size(); ++i) delta[i] = toCauchy * cauchy_[i] + toFull * full_[i];
  }

  /// cost(x) − model(δ) = −2gᵀδ − δᵀHδ.
  double predictedDecrease(const LinearSystem& system, std::span<const double> delta) {
    system.multiply(delta, product_);
    return -2.0 * dot(system.gradient(), delta) - dot(delta, product_);
  }

  double norm(std::span<const double> delta) const { return std::sqrt(scaledDot(delta, delta)); }
  double fullNorm() const { return fullNorm_; }
  /// −gᵀδ of the full step, by which the model falls there: no step promises more.
  double fullPromise() const { return fullPromise_; }
  double regularization() const { return used_; }

 private:
  double scaledDot(std::span<const double> a, std::span<const double> b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * scale_[i] * b[i];
    return sum;
  }

  LinearOutcome solveFull(Descent& descent) {
    used_ = regularization_;
    while (true) {
      for (std::size_t i = 0; i < scale_.size(); ++i) damping_[i] = used_ * scale_[i];
      const std::span<const double> damping =
          used_ > 0.0 ? std::span<const double>(damping_) : std::span<const double>();
      const LinearOutcome outcome = descent.system().solve(damping, full_, descent.stop());
      const bool indefinite =
          outcome.kind == LinearOutcome::Kind::notPositiveDefinite || outcome.kind == LinearOutcome::Kind::notConverged;
      if (!indefinite || used_ >= mostRegularization) {
        // What sufficed here is more than enough next time, or nothing is needed any more.
        regularization_ = used_ > leastRegularization ? 0.1 * used_ : 0.0;
        return outcome;
      }
      used_ = std::max(leastRegularization, 10.0 * used_);
    }
  }

  std::vector<double>& scale_;
  std::vector<double>& cauchy_;
  std::vector<double>& full_;
  std::vector<double>& product_;
  std::vector<double>& damping_;
  double cauchyNorm_ = 0.0;
  double fullNorm_ = 0.0;
  double fullPromise_ = 0.0;
  double regularization_ = 0.0;
  double used_ = 0.0;
};

}  // namespace

void dogleg(Descent& descent) {
  std::vector<double>& delta = descent.delta();
  DoglegPath path(descent);
  double radius = std::numeric_limits<double>::infinity();  // the first full step is tried
  double ratio = 1.0;
  while (!descent.exhausted()) {
    const LinearOutcome outcome = path.compute(descent, ratio);
    if (!outcome.ok()) return descent.fail(outcome);
    descent.setLinearIterations(outcome.iterations);
    for (bool accepted = false; !accepted && !descent.exhausted();) {
      path.stepOfLength(radius, delta);
      descent.setDamping(path.regularization());
      const bool whole = path.fullNorm() <= radius;
      // H + μD is all D where the memory of D is far above H.
      const bool stiff = path.regularization() * descent.dampingScale().excess() > 1.0;
      descent.setReach(whole && !stiff ? StepReach::full : StepReach::shortened);
      const double length = path.norm(delta);
      const double predicted = path.predictedDecrease(descent.system(), delta);
      const CostTotals trial = descent.tryStep();
      const double actual = descent.totals().cost - trial.cost;
      ratio = trial.finite() && predicted > 0.0 ? actual / predicted : -1.0;
      // Where the model promises less than rounding can tell, a full step that does not raise the cost is as good as
      // the model says.
      if (whole && trial.finite() && predicted <= 1e-13 * descent.totals().cost && actual >= 0.0) ratio = 1.0;
      if (ratio > 0.75) radius = std::max(radius, 3.0 * length);
      if (ratio < 0.25) radius = 0.5 * std::min(radius, length);
      accepted = ratio > acceptedShare;
      if (accepted) {
        if (descent.accept(trial)) return;
        continue;
      }
      descent.reject();
      // A promise made small by the radius alone proves nothing: only that of the full step counts.
      const double promise = path.fullPromise();
      if (promise > 0.0 && promise <= descent.options().costTolerance * descent.totals().cost &&
          !(stiff && descent.isSteep()))
        return descent.finishWithoutProspect(promise);
      if (descent.atRest(whole)) return descent.finishAtRest();
      if (radius <= leastRadius * path.fullNorm()) {
        return descent.finish(Status::stalled, detail::stalledReason);
      }
    }
  }
}

}  // namespace quiver
