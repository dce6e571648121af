#include <quiver/solvers/linear_outcome.h>

namespace quiver {
namespace {

LinearOutcome::Kind kindOf(SolverStatus::Outcome outcome) {
  switch (outcome) {
    case SolverStatus::Outcome::success:
      return LinearOutcome::Kind::success;
    case SolverStatus::Outcome::notPositiveDefinite:
      return LinearOutcome::Kind::notPositiveDefinite;
    case SolverStatus::Outcome::notConverged:
      return LinearOutcome::Kind::notConverged;
    case SolverStatus::Outcome::interrupted:
      return LinearOutcome::Kind::interrupted;
    case SolverStatus::Outcome::memoryLimit:
      break;
  }
  return LinearOutcome::Kind::memoryLimit;
}

}  // namespace

LinearOutcome outcomeOf(const SolverStatus& status, const LinearSolver& solver) {
  return {kindOf(status.outcome), -1, status.coordinate, status.pivot, solver.statistics().iterations};
}

}  // namespace quiver
