#pragma once

#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// "eigen": Eigen's simplicial LDLᵀ on scalars, one thread. Structure is analysed once; slow next to "block", kept as
/// an independent reference.
std::unique_ptr<LinearSolver> makeEigenSolver();

}  // namespace quiver
