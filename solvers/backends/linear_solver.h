#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <quiver/core/util/stop_condition.h>
#include <quiver/solvers/block/block_matrix.h>
#include <quiver/solvers/block/ordering.h>

namespace quiver {

/// How a factorisation or an iteration ended. `block` is an index in the pattern given to `analyze`.
struct SolverStatus {
  enum class Outcome { success, notPositiveDefinite, notConverged, interrupted, memoryLimit };
  Outcome outcome = Outcome::success;
  /// The first block whose pivot was not positive, −1 if none.
  int block = -1;
  /// Which scalar of that block, and its pivot's value.
  int coordinate = -1;
  double pivot = 0.0;

  bool ok() const { return outcome == Outcome::success; }
};

/// What an analysis predicts and a factorisation has.
struct FactorStatistics {
  /// Scalars of the factor L, padding not counted.
  std::int64_t nonzeros = 0;
  /// Multiplications and additions of L's computation, padding not counted: Σ over scalar columns of c², c entries
  /// each.
  double flops = 0.0;
  /// Bytes the solver holds for the factor and its work space.
  std::int64_t bytes = 0;
  /// Iterations of the last solve, for iterative solvers.
  int iterations = 0;
};

/// Solves (H + diag(damping)) x = b for a symmetric positive definite block-sparse H; structure once, numbers many
/// times.
///
/// The caller permutes: it asks `order`, lays H out in that order, and calls everything else in it. Not thread safe;
/// one object serves one system. What a solver computes has the same bits for any `threads` unless its documentation
/// says otherwise.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// As the registry and the reports call it.
  virtual std::string name() const = 0;

  /// The elimination order this solver wants for a pattern in natural order. Pure. The default is the natural order.
  virtual BlockOrdering order(const BlockPattern& pattern) const;

  /// Prepares for matrices of this pattern (already in elimination order). After it `factorize` and `solve` do not
  /// allocate.
  virtual void analyze(std::shared_ptr<const BlockPattern> pattern, int threads) = 0;

  /// Another descent begins with the same structure: what was learnt from earlier right-hand sides is forgotten.
  virtual void restart() {}

  /// Factors H + diag(damping); `damping` has one non-negative entry a scalar, or is empty. H is not changed. `stop` is
  /// polled inside; after Outcome::interrupted the factor is unusable.
  virtual SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                                 const StopCondition& stop = {}) = 0;

  /// Overwrites `count` right-hand sides (column after column) with the solutions of the last factorisation.
  virtual SolverStatus solve(std::span<double> rightHandSides, int count = 1) = 0;

  /// Factors and solves for one right-hand side, which is overwritten, in case of failure by anything: what a step of a
  /// descent needs. A direct solver substitutes forward while each part of the factor is still near, which saves
  /// reading the factor once; the bits are those of `factorize` and `solve`.
  virtual SolverStatus factorizeAndSolve(const BlockMatrix& matrix, std::span<const double> damping,
                                         std::span<double> rightHandSide, const StopCondition& stop = {});

  /// How long the last factorizeAndSolve took after the factor was complete.
  double solveSeconds() const { return solveSeconds_; }

  virtual FactorStatistics statistics() const = 0;

 protected:
  double solveSeconds_ = 0.0;
};

}  // namespace quiver
