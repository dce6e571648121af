#include <quiver/solvers/elimination/conjugate_reduction.h>

#include <algorithm>
#include <cmath>

namespace quiver {
namespace {

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

LinearOutcome ConjugateReduction::solve(std::span<double> x, const Precondition& precondition, const Multiply& multiply,
                                        const StopCondition& stop) {
  LinearOutcome outcome;
  const std::size_t n = x.size();
  residual_.assign(x.begin(), x.end());
  std::fill(x.begin(), x.end(), 0.0);
  scaled_ = residual_;
  product_.resize(n);
  if (const SolverStatus status = precondition(scaled_); !status.ok())
    return {.kind = LinearOutcome::Kind::notPositiveDefinite};
  double rho = dot(residual_, scaled_);
  if (!(rho > 0.0)) return outcome;
  const double target = forcing_.next(std::sqrt(rho)) * std::sqrt(rho);
  direction_ = scaled_;
  const int most =
      limits_.maxIterations > 0 ? limits_.maxIterations : static_cast<int>(std::min<std::size_t>(10 * n, 10000));
  while (outcome.iterations < most) {
    if (stop.reached()) {
      outcome.kind = LinearOutcome::Kind::interrupted;
      return outcome;
    }
    multiply(direction_, product_);
    const double curvature = dot(direction_, product_);
    if (!(curvature > 0.0)) {
      outcome.kind = LinearOutcome::Kind::notPositiveDefinite;
      return outcome;
    }
    const double length = rho / curvature;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += length * direction_[i];
      residual_[i] -= length * product_[i];
    }
    ++outcome.iterations;
    scaled_ = residual_;
    (void)precondition(scaled_);
    const double next = dot(residual_, scaled_);
    if (!(std::sqrt(std::max(next, 0.0)) > target)) return outcome;
    for (std::size_t i = 0; i < n; ++i) direction_[i] = scaled_[i] + next / rho * direction_[i];
    rho = next;
  }
  outcome.kind = LinearOutcome::Kind::notConverged;
  return outcome;
}

}  // namespace quiver
