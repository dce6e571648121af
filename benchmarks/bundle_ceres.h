#pragma once

#include <string>

namespace quiver::bench {

struct CeresBundleResult {
  /// Reading the file and building the problem, and solving it.
  double loadSeconds = 0.0;
  double solveSeconds = 0.0;
  /// All iterations together, without what comes before the first.
  double iterationSeconds = 0.0;
  int iterations = 0;
  /// ½ Σ r².
  double cost = 0.0;
};

/// Solves a file of "bundle adjustment in the large" with one of Ceres's Schur solvers, dense or sparse, points first,
/// its Jacobians by automatic differentiation as in Ceres's own program for such files.
CeresBundleResult solveBundleWithCeres(const std::string& file, int iterations, int threads, bool sparse);

}  // namespace quiver::bench
