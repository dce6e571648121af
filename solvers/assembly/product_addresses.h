#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/problem/product_targets.h>
#include <quiver/solvers/assembly/assembly_plan.h>

namespace quiver {

/// The addresses that a batch's product loop writes to, from the plan's offsets: one pointer an edge and role, or pair
/// of roles, computed once for all iterations.
class ProductAddresses {
 public:
  /// Where the plan's offsets begin, and by piece the memory for what nobody reads: parts of fixed vertices and of
  /// lanes beyond the last edge.
  struct Memory {
    double* records;
    double* shared;
    double* matrix;
    double* nowhere;
    std::int64_t nowhereNumbers;
  };
  /// For batch `batch`, all of whose edges have `roles` roles. O(edges · roles²).
  ProductAddresses(const Problem& problem, const AssemblyPlan& plan, int batch, int roles, const Memory& memory);

  ProductTargets targets() const { return {recordArrays_.data(), blockArrays_.data(), flippedArrays_.data()}; }

 private:
  void placeEdge(const AssemblyPlan& plan, int batch, int edge, double* nowhere, const Memory& memory);

  std::vector<std::vector<double*>> records_;
  std::vector<std::vector<double*>> blocks_;
  std::vector<std::vector<std::int64_t>> flipped_;
  std::vector<double* const*> recordArrays_;
  std::vector<double* const*> blockArrays_;
  std::vector<const std::int64_t*> flippedArrays_;
};

}  // namespace quiver
