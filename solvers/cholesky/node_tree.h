#pragma once

#include <cstdint>
#include <vector>

#include <quiver/solvers/block/factor_pattern.h>

namespace quiver::detail {

/// A piece of the factorisation: a front (block columns with one set of rows below, handled as a dense matrix) or a
/// leaf subtree (a whole subtree of the elimination tree whose block columns are stored one by one).
struct TreeNode {
  bool leaf = false;
  /// Block columns [firstBlock, lastBlock) in the factor's numbering.
  int firstBlock = 0;
  int lastBlock = 0;
  /// A later node, or −1.
  int parent = -1;
  /// Scalars of the columns and of the rows below them all.
  int columns = 0;
  int rows = 0;
  /// Predicted nanoseconds.
  double cost = 0.0;
};

/// How the elimination tree is cut into fronts and leaf subtrees: by predicted cost, from structure alone.
///
/// The nodes are in postorder, and the factor's numbering follows them: a renumbering of the elimination order that
/// keeps ancestors after descendants, so that L has the same blocks.
struct NodeTree {
  std::vector<TreeNode> nodes;
  /// order[i]: the position in the elimination order of the i-th block in the factor's numbering; position is its
  /// inverse.
  std::vector<int> order;
  std::vector<int> position;
  /// For each block of a leaf subtree in the factor's numbering: how many from it on form a group, none of which is an
  /// ancestor of another; 0 inside a group and for the blocks of fronts.
  std::vector<int> groups;

  /// `dimensions` and `factor` are in elimination order, which is a postorder of the tree. Leaf subtrees are formed for
  /// matrices of one block dimension up to largestLeafDimension.
  NodeTree(const std::vector<int>& parent, const FactorPattern& factor, const std::vector<int>& dimensions);
};

}  // namespace quiver::detail
