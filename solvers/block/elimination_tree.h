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

/// The inverse of an order: where each block stands in it.
std::vector<int> positionsOf(std::span<const int> order);

/// A postorder of a forest given by parents: result[k] is the node visited k-th. Children are visited in ascending
/// order of `weight` (ties and an empty weight: ascending index). O(nodes log nodes).
std::vector<int> postorder(std::span<const int> parent, std::span<const double> weight = {});

}  // namespace quiver
