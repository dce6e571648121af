#pragma once

#include <functional>
#include <span>
#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/backends/forcing_term.h>
#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// Preconditioned conjugate gradients for the reduced system S x = s, given by its products alone.
///
/// A step far from the optimum need not be exact: the solve ends at √(rᵀM⁻¹r) ≤ η √(sᵀM⁻¹s), where η begins at 0.01 and
/// falls to `tolerance` as the right-hand sides of successive systems do (ForcingTerm).
class ConjugateReduction {
 public:
  struct Limits {
    double tolerance = 1e-8;
    /// 0 means ten times the scalars, at most 10000.
    int maxIterations = 0;
  };
  using Precondition = std::function<SolverStatus(std::span<double>)>;
  using Multiply = std::function<void(std::span<const double>, std::span<double>)>;

  ConjugateReduction() = default;
  explicit ConjugateReduction(const Limits& limits) : limits_(limits), forcing_(0.01, limits.tolerance) {}

  /// Another descent begins.
  void restart() { forcing_.restart(); }

  /// Overwrites x, which holds s, with the solution. Polls `stop` once an iteration.
  LinearOutcome solve(std::span<double> x, const Precondition& precondition, const Multiply& multiply,
                      const StopCondition& stop);

 private:
  Limits limits_;
  ForcingTerm forcing_;
  std::vector<double> residual_;
  std::vector<double> scaled_;
  std::vector<double> direction_;
  std::vector<double> product_;
};

}  // namespace quiver
