#pragma once

#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// "power": the series Σᵢ (I − M⁻¹H)ⁱ M⁻¹ b, where M is H's diagonal blocks times the largest number of blocks in a
/// row: then it converges for every positive definite H. After elimination the system sums the far faster series of the
/// reduced matrix instead (PowerSeries). `factorize` factors the diagonal blocks and keeps a reference to the matrix.
/// Ends with notConverged, the sum so far in place, after `terms` terms.
std::unique_ptr<LinearSolver> makePowerSolver(double tolerance = 1e-10, int terms = 10000);

}  // namespace quiver
