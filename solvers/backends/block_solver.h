#pragma once

#include <cstdint>
#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

/// "block": quiver's own sparse block Cholesky, for any block dimensions; the default. Kernels for the processor's
/// instruction set are chosen at run time. The same bits for any number of threads; no allocation after `analyze`.
std::unique_ptr<LinearSolver> makeBlockSolver();
/// Bytes that it would hold for a pattern in elimination order and so many threads, after an analysis for that alone.
std::int64_t predictBlockSolverBytes(const BlockPattern& pattern, int threads);

}  // namespace quiver
