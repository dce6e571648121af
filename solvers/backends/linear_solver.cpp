#include <quiver/solvers/backends/linear_solver.h>

#include <quiver/core/util/stopwatch.h>

namespace quiver {

BlockOrdering LinearSolver::order(const BlockPattern& pattern) const { return naturalOrdering(pattern.blocks()); }

SolverStatus LinearSolver::factorizeAndSolve(const BlockMatrix& matrix, std::span<const double> damping,
                                             std::span<double> rightHandSide, const StopCondition& stop) {
  SolverStatus status = factorize(matrix, damping, stop);
  const Stopwatch watch;
  if (status.ok()) status = solve(rightHandSide);
  solveSeconds_ = watch.seconds();
  return status;
}

}  // namespace quiver
