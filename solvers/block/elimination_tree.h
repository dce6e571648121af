#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/solvers/block/block_pattern.h>

namespace quiver {

/// The undirected graph of a block pattern: who shares an off-diagonal block with whom, both directions stored, no
/// loops.
struct BlockGraph {
  /// Neighbours of block i are neighbours[starts[i]] … neighbours[starts[i + 1] − 1], ascending; those from middles[i]
  /// on are larger than i.
  std::vector<std::int64_t> starts;
  std::vector<std::int64_t> middles;
  std::vector<int> neighbours;

  BlockGraph() = default;
  /// O(entries + blocks).
  explicit BlockGraph(const BlockPattern& pattern);

  int blocks() const { return static_cast<int>(starts.size()) - 1; }
  std::span<const int> of(int block) const {
    const auto at = static_cast<std::size_t>(block);
    return {neighbours.data() + starts[at], neighbours.data() + starts[at + 1]};
  }
  std::span<const int> smaller(int block) const {
    const auto at = static_cast<std::size_t>(block);
    return {neighbours.data() + starts[at], neighbours.data() + middles[at]};
  }
  std::span<const int> larger(int block) const {
    const auto at = static_cast<std::size_t>(block);
    return {neighbours.data() + middles[at], neighbours.data() + starts[at + 1]};
  }
};

/// The inverse of an order: where each block stands in it.
std::vector<int> positionsOf(std::span<const int> order);

/// A block graph whose blocks are known by their positions in an order; both must outlive it.
class OrderedGraph {
 public:
  OrderedGraph(const BlockGraph& graph, std::span<const int> order);

  /// Calls visit(j) for the neighbours of i that stand before it, or behind it.
  template <typename Visit>
  void forEachBefore(int i, const Visit& visit) const {
    if (natural_) {
      for (const int j : graph_.smaller(i)) visit(j);
      return;
    }
    for (const int neighbour : graph_.of(order_[static_cast<std::size_t>(i)])) {
      const int j = position_[static_cast<std::size_t>(neighbour)];
      if (j < i) visit(j);
    }
  }
  template <typename Visit>
  void forEachBehind(int i, const Visit& visit) const {
    if (natural_) {
      for (const int j : graph_.larger(i)) visit(j);
      return;
    }
    for (const int neighbour : graph_.of(order_[static_cast<std::size_t>(i)])) {
      const int j = position_[static_cast<std::size_t>(neighbour)];
      if (j > i) visit(j);
    }
  }

 private:
  const BlockGraph& graph_;
  std::span<const int> order_;
  bool natural_ = true;
  std::vector<int> position_;
};

/// The elimination tree of a block graph under an order; indices are positions in the order, parents come after their
/// children.
struct EliminationTree {
  /// parent[i] > i, or −1 for a root.
  std::vector<int> parent;

  /// `order[i]` is the block eliminated i-th. O(entries · log blocks) at worst.
  EliminationTree(const BlockGraph& graph, std::span<const int> order);
};

/// Whether 0, 1, 2, … is a postorder of a forest given by parents: every subtree is a run that ends with its root.
/// O(nodes).
bool isPostordered(std::span<const int> parent);

/// A postorder of a forest given by parents: result[k] is the node visited k-th. Children are visited in ascending
/// order of `weight` (ties and an empty weight: ascending index). O(nodes log nodes).
std::vector<int> postorder(std::span<const int> parent, std::span<const double> weight = {});

}  // namespace quiver
