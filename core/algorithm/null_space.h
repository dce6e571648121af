#pragma once

#include <vector>

#include <quiver/core/algorithm/linear_system.h>
#include <quiver/core/problem/problem.h>

namespace quiver {

/// Directions in which H is zero to rounding.
struct NullSpace {
  /// Columns, each with entries for all scalars of the problem, of length 1 in the norm vᵀDv, D = diag(H) bounded
  /// below.
  std::vector<std::vector<double>> directions;
  /// False if H could not be factored even damped; then nothing is known.
  bool computed = false;
};

/// Finds up to seven null directions of the last linearisation by subspace iteration with (H + εD)⁻¹ D and the
/// Rayleigh–Ritz values vᵀHv / vᵀDv, of which those below 1e-9 count. It knows nothing of vertex types. Costs one
/// factorisation and some 30 solves; overwrites the system's factor.
NullSpace findNullSpace(const Problem& problem, LinearSystem& system, const StopCondition& stop);

}  // namespace quiver
