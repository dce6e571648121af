#pragma once

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// What a linear solver's status means to an algorithm, but for the variable: the solver knows blocks in its own order
/// only.
LinearOutcome outcomeOf(const SolverStatus& status, const LinearSolver& solver);

}  // namespace quiver
