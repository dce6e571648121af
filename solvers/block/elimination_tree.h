#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/solvers/block/block_pattern.h>

namespace quiver {

/// The undirected graph of a block pattern: who shares an off-diagonal block with whom, both directions stored, no
/// loops.
struct BlockGraph {
  /// Neighbours of block i are neighbours[starts[i]] … neighbours[starts[i + 1] − 1], ascending.
  std::vector<std::int64_t> starts;
  std::vector<int> neighbours;

  BlockGraph() = default;
  /// O(entries + blocks).
  explicit BlockGraph(const BlockPattern& pattern);

  int blocks() const { return static_cast<int>(starts.size()) - 1; }
  std::span<const int> of(int block) const {
    const auto begin = static_cast<std::size_t>(starts[static_cast<std::size_t>(block)]);
    const auto end = static_cast<std::size_t>(starts[static_cast<std::size_t>(block) + 1]);
    return {neighbours.data() + begin, end - begin};
  }
};

/// The elimination tree of a block graph under an order; indices are positions in the order, parents come after their
/// children.
struct EliminationTree {
  /// parent[i] > i, or −1 for a root.
  std::vector<int> parent;

  /// `order[i]` is the block eliminated i-th. O(entries · log blocks) at worst.
  EliminationTree(const BlockGraph& graph, std::span<const int> order);
};

/// A postorder of a forest given by parents: result[k] is the node visited k-th. Children are visited in ascending
/// order of `weight` (ties and an empty weight: ascending index). O(nodes log nodes).
std::vector<int> postorder(std::span<const int> parent, std::span<const double> weight = {});

/// What a Cholesky factorisation costs: scalars of L, and multiplications and additions (Σ c² over scalar columns with
/// c entries).
struct FactorSize {
  std::int64_t nonzeros = 0;
  double flops = 0.0;
};

/// Scalars of L below each diagonal block, per block column: the sum of the dimensions of the blocks there. O(blocks of
/// L).
std::vector<std::int64_t> belowScalars(const BlockGraph& graph, std::span<const int> order, const EliminationTree& tree,
                                       const BlockLayout& layout);

/// Sizes of a factor whose block column i, of dimension `dimensions[i]`, has `below[i]` scalars under its diagonal
/// block.
FactorSize factorSize(std::span<const int> dimensions, std::span<const std::int64_t> below);

/// Sizes of L for the pattern eliminated in the given order. O(blocks of L).
FactorSize predictFactor(const BlockPattern& pattern, std::span<const int> order);

/// The blocks of L below the diagonal: compressed columns, rows ascending, in positions of the order.
struct FactorPattern {
  std::vector<std::int64_t> columns;
  std::vector<int> rows;

  /// O(blocks of L).
  FactorPattern(const BlockGraph& graph, std::span<const int> order, const EliminationTree& tree);

  std::span<const int> column(int j) const {
    const auto begin = static_cast<std::size_t>(columns[static_cast<std::size_t>(j)]);
    const auto end = static_cast<std::size_t>(columns[static_cast<std::size_t>(j) + 1]);
    return {rows.data() + begin, end - begin};
  }
};

}  // namespace quiver
