#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/solvers/block/elimination_tree.h>

namespace quiver {

/// What a Cholesky factorisation costs: scalars of L, and multiplications and additions (Σ c² over scalar columns with
/// c entries).
struct FactorSize {
  std::int64_t nonzeros = 0;
  double flops = 0.0;
};

/// Sizes of a factor whose block column i, of dimension `dimensions[i]`, has `below[i]` scalars under its diagonal
/// block.
FactorSize factorSize(std::span<const int> dimensions, std::span<const std::int64_t> below);

/// Sizes of L for the pattern eliminated in the given order. Nearly O(entries of the pattern).
FactorSize predictFactor(const BlockPattern& pattern, std::span<const int> order);
/// The same for a graph that has been made of it.
FactorSize predictFactor(const BlockGraph& graph, const BlockLayout& layout, std::span<const int> order);

/// The blocks of L below the diagonal: rows of each column, ascending, in positions of the order.
///
/// A column whose rows are those of the column before, less the first, shares their list: what is kept and what is
/// computed is as large as the rows of the first columns of the chains.
class FactorPattern {
 public:
  FactorPattern(const BlockGraph& graph, std::span<const int> order, const EliminationTree& tree);

  std::span<const int> column(int j) const {
    const auto at = static_cast<std::size_t>(j);
    return {rows_.data() + begins_[at], static_cast<std::size_t>(counts_[at])};
  }
  /// Σ weight[i] over the rows of each column; weights are in positions of the order.
  std::vector<std::int64_t> columnWeights(std::span<const int> weights) const;

 private:
  std::vector<int> heads_;  // the first columns of the chains
  std::vector<std::int64_t> begins_;
  std::vector<std::int64_t> counts_;
  std::vector<int> rows_;
};

}  // namespace quiver
