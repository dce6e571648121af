#pragma once

#include <span>
#include <vector>

#include <quiver/core/problem/problem.h>
#include <quiver/solvers/assembly/assembly_plan.h>
#include <quiver/solvers/block/block_matrix.h>

namespace quiver {

/// The second pass of assembly: every vertex adds its records in the order of pieces and writes its diagonal block of
/// H, its part of g and of the diagonal of H.
struct DiagonalGather {
  const Problem& problem;
  const AssemblyPlan& plan;
  /// First number of each variable's diagonal block in the matrix.
  const std::vector<std::int64_t>& blocks;
  /// Numbers of the first record of larger vertices are overwritten.
  double* records;
  BlockMatrix& matrix;
  std::span<double> gradient;
  std::span<double> diagonal;

  /// Variables begin … end − 1. Several threads may run different ranges.
  void run(int begin, int end) const;

 private:
  template <int D>
  void gather(int first, int last) const;
  void gatherAny(int variable, int dimension) const;
  void holdDirections(int variable) const;
};

}  // namespace quiver
