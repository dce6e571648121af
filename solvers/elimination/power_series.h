#pragma once

#include <functional>
#include <span>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// The reduced system S x = s with S = U − W V⁻¹ Wᵀ by the series x = Σᵢ (I − M⁻¹ S)ⁱ M⁻¹ s, M = m D, given by products
/// with S and the factored diagonal blocks D of U, the kept vertices' part. Where no edge joins more than m kept
/// vertices, U ≤ m D, so M⁻¹ S has no eigenvalue beyond (0, 1]: the series converges, and every partial sum is a step
/// downhill; but slowly where damping is small. No scalar products, so it suits starts far from the optimum.
class PowerSeries {
 public:
  struct Limits {
    /// Ends after term i where i ‖term‖ ≤ tolerance ‖sum‖ …
    double tolerance = 0.01;
    /// … or after so many terms.
    int terms = 20;
    /// m: the most kept vertices that an edge joins.
    double divisor = 1.0;
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
