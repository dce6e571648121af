#pragma once

#include <string>

namespace quiver::bench {

struct CeresResult {
  double chi2 = 0.0;
  int iterations = 0;
  /// Reading the file and building the problem; the solve; its median iteration.
  double loadSeconds = 0.0;
  double solveSeconds = 0.0;
  double iterationSeconds = 0.0;
  bool converged = false;
};

/// Reads a pose graph of EDGE_SE2 or EDGE_SE3:QUAT and minimises the same errors as quiver with Ceres: automatic
/// derivatives, quaternion manifold, first pose constant, SPARSE_NORMAL_CHOLESKY, Levenberg–Marquardt. With `toOptimum`
/// it stops by relative cost 1e-10, else only after `iterations`.
CeresResult solveWithCeres(const std::string& file, int iterations, int threads, bool toOptimum);

}  // namespace quiver::bench
