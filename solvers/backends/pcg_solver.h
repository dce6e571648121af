#pragma once

#include <memory>

#include <quiver/solvers/backends/linear_solver.h>

namespace quiver {

struct PcgOptions {
  /// Ends when √(rᵀM⁻¹r) ≤ tolerance √(bᵀM⁻¹b), M the diagonal blocks: a norm that does not depend on units.
  double tolerance = 1e-8;
  /// Iterations at most; 0 means ten times the scalars, at most 10000.
  int maxIterations = 0;
  /// The first solve after each factorisation begins with a tolerance of 0.1 and tightens it as the right-hand sides
  /// fall (ForcingTerm); other solves are exact.
  bool forcing = false;
};

/// "pcg": conjugate gradients on the block matrix, preconditioned with its diagonal blocks. Memory of a few vectors
/// beside the matrix; time grows with the condition. `factorize` factors the diagonal blocks and keeps a reference to
/// the matrix, whose numbers `solve` uses; `statistics().iterations` counts those of the last solve. The same bits for
/// any number of threads. A solve ends with notConverged at the limit, the best iterate in place, and with
/// notPositiveDefinite (block −1) if it meets a direction of no curvature.
std::unique_ptr<LinearSolver> makePcgSolver(const PcgOptions& options = {});

}  // namespace quiver
