#pragma once

#include <cstdint>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// Doubles of a matrix of that pattern.
std::int64_t matrixNumbers(const BlockPattern& pattern);

/// Bytes that a linear solver is going to hold for a matrix of that pattern, which is in the solver's order; the matrix
/// itself not counted. As long as an analysis for so many threads.
std::int64_t predictSolverBytes(const LinearSolver& solver, const BlockPattern& pattern, int threads);

}  // namespace quiver
