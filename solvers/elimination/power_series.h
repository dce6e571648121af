#pragma once

#include <functional>
#include <span>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// The reduced system S x = s with S = U − W V⁻¹ Wᵀ by the series x = Σᵢ (U⁻¹ W V⁻¹ Wᵀ)ⁱ U⁻¹ s, given by products with
/// S and the factored diagonal blocks U of the kept vertices. It converges whatever S is, since U⁻¹ S has no eigenvalue
/// beyond (0, 1], and every partial sum is a step downhill; but slowly where damping is small. No scalar products, so
/// it suits starts far from the optimum.
class PowerSeries {
 public:
  struct Limits {
    /// Ends after term i where i ‖term‖ ≤ tolerance ‖sum‖ …
    double tolerance = 0.01;
    /// … or after so many terms.
    int terms = 20;
  };
  using Precondition = std::function<SolverStatus(std::span<double>)>;
  using Multiply = std::function<void(std::span<const double>, std::span<double>)>;

  PowerSeries() = default;
  explicit PowerSeries(const Limits& limits) : limits_(limits) {}

  /// Overwrites x, which holds s, with the sum. A series that is cut off is a success. Polls `stop` once a term.
  LinearOutcome solve(std::span<double> x, const Precondition& precondition, const Multiply& multiply,
                      const StopCondition& stop);

 private:
  Limits limits_;
  std::vector<double> term_;
  std::vector<double> product_;
};

}  // namespace quiver
