#pragma once

#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// "dense": a dense Cholesky of the whole matrix, for systems that are small or full. n² doubles, n³/3 multiplications
/// and additions.
std::unique_ptr<LinearSolver> makeDenseSolver();

}  // namespace quiver
