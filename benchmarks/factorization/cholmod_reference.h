#pragma once

#include <memory>

#include <quiver/solvers/block/block_matrix.h>

namespace quiver::bench {

/// CHOLMOD as the benchmark's opponent: a given order, supernodal or simplicial as demanded, BLAS as the process has
/// set it.
class CholmodReference {
 public:
  /// `matrix` is already in elimination order.
  CholmodReference(const BlockMatrix& matrix, bool supernodal);
  ~CholmodReference();
  CholmodReference(CholmodReference&&) noexcept;

  /// Throws Error unless the matrix is positive definite.
  void factorize();
  /// Overwrites x with the solution.
  void solve(double* x);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quiver::bench
