#pragma once

#include <string>

namespace quiver::bench {

/// The BLAS library of this process.
struct Blas {
  /// Its own description, or "ATLAS", "reference BLAS", "none".
  std::string name;
  /// The file it was loaded from; empty if it could not be found.
  std::string file;
  /// Whether peers that run on it are measured fairly: OpenBLAS, BLIS or MKL.
  bool optimized = false;
};

/// Finds the BLAS that CHOLMOD and Ceres call and sets it to one thread, with which both are fastest on block-sparse
/// matrices.
Blas singleThreadedBlas();

/// Prints the library. Throws Error if it is a slow one and `anyBlas` is false: ratios to peers on it mean nothing.
Blas demandBlas(bool anyBlas);

}  // namespace quiver::bench
