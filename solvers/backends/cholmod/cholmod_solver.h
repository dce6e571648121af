#pragma once

#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// "cholmod": SuiteSparse's CHOLMOD on scalars, supernodal or simplicial as it decides, BLAS on one thread. GPL: it
/// lives in a library of its own, quiver::cholmod. CHOLMOD does not tell the value of a failed pivot:
/// SolverStatus::pivot is NaN then. Throws Error when CHOLMOD runs out of memory in `analyze`.
std::unique_ptr<LinearSolver> makeCholmodSolver();

}  // namespace quiver
