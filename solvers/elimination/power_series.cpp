#include <quiver/solvers/elimination/power_series.h>

#include <algorithm>
#include <cmath>

namespace quiver {
namespace {

double norm(std::span<const double> a) {
  double sum = 0.0;
  for (const double value : a) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace

LinearOutcome PowerSeries::solve(std::span<double> x, const Precondition& precondition, const Multiply& multiply,
                                 const StopCondition& stop) {
  LinearOutcome outcome;
  product_.resize(x.size());
  if (const SolverStatus status = precondition(x); !status.ok())
    return {.kind = LinearOutcome::Kind::notPositiveDefinite};
  for (double& value : x) value /= limits_.divisor;
  term_.assign(x.begin(), x.end());
  while (outcome.iterations + 1 < limits_.terms) {
    if (stop.reached()) {
      outcome.kind = LinearOutcome::Kind::interrupted;
      return outcome;
    }
    // term ← (I − M⁻¹ S) term
    multiply(term_, product_);
    (void)precondition(product_);
    for (std::size_t i = 0; i < x.size(); ++i) {
      term_[i] -= product_[i] / limits_.divisor;
      x[i] += term_[i];
    }
    ++outcome.iterations;
    if (!(outcome.iterations * norm(term_) > limits_.tolerance * norm(x))) break;
  }
  return outcome;
}

}  // namespace quiver
