#include <quiver/solvers/block/column_weights.h>

#include <numeric>

namespace quiver {
namespace {

/// Row i of L is a subtree of the elimination tree with root i whose leaves are entries of A. Met in postorder, an
/// entry is a leaf if nothing of the same row has been met in its own subtree.
class RowSubtrees {
 public:
  RowSubtrees(std::span<const int> parent, std::span<const int> post)
      : first_(parent.size(), -1), lastFirst_(parent.size(), -1), lastLeaf_(parent.size(), -1), above_(parent.size()) {
    for (int k = 0; k < static_cast<int>(post.size()); ++k) {
      above_[at(post[at(k)])] = post[at(k)];
      for (int j = post[at(k)]; j >= 0 && first_[at(j)] < 0; j = parent[at(j)]) first_[at(j)] = k;
    }
  }

  /// Whether column j is the first of its subtree: a leaf of the elimination tree.
  bool isTreeLeaf(int j, int place) const { return first_[at(j)] == place; }

  /// Entry (row, column) is met. Returns whether it is a leaf of the row's subtree; `common` becomes the least common
  /// ancestor of it and the leaf before, −1 if it is the first.
  bool meet(int row, int column, int& common) {
    if (first_[at(column)] <= lastFirst_[at(row)]) return false;
    lastFirst_[at(row)] = first_[at(column)];
    const int before = lastLeaf_[at(row)];
    lastLeaf_[at(row)] = column;
    common = before < 0 ? -1 : topOf(before);
    return true;
  }

  /// Column j is finished: what is met from now on in its parent's subtree is beside it.
  void close(int j, int parent) { above_[at(j)] = parent; }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  int topOf(int j) {
    int top = j;
    while (above_[at(top)] != top) top = above_[at(top)];
    while (j != top) {
      const int next = above_[at(j)];
      above_[at(j)] = top;
      j = next;
    }
    return top;
  }

  std::vector<int> first_;      // the place in postorder of the first descendant
  std::vector<int> lastFirst_;  // of the row's last leaf
  std::vector<int> lastLeaf_;
  std::vector<int> above_;  // an ancestor among finished columns; the top of a tree of them is its own
};

}  // namespace

std::vector<std::int64_t> columnWeights(const BlockGraph& graph, std::span<const int> order,
                                        const EliminationTree& tree, std::span<const int> weights) {
  std::vector<int> post;
  if (isPostordered(tree.parent)) {
    post.resize(tree.parent.size());
    std::iota(post.begin(), post.end(), 0);
  } else {
    post = postorder(tree.parent);
  }
  const OrderedGraph ordered(graph, order);
  RowSubtrees subtrees(tree.parent, post);
  // Of each column, diagonal included, less those of its children: they overlap in what leaves and ancestors tell.
  std::vector<std::int64_t> sums(order.size(), 0);
  for (int k = 0; k < static_cast<int>(post.size()); ++k) {
    const int j = post[static_cast<std::size_t>(k)];
    const int up = tree.parent[static_cast<std::size_t>(j)];
    std::int64_t& own = sums[static_cast<std::size_t>(j)];
    if (subtrees.isTreeLeaf(j, k)) own += weights[static_cast<std::size_t>(j)];
    if (up >= 0) sums[static_cast<std::size_t>(up)] -= weights[static_cast<std::size_t>(j)];
    ordered.forEachBehind(j, [&](int row) {
      int common = -1;
      if (!subtrees.meet(row, j, common)) return;
      own += weights[static_cast<std::size_t>(row)];
      if (common >= 0) sums[static_cast<std::size_t>(common)] -= weights[static_cast<std::size_t>(row)];
    });
    if (up >= 0) subtrees.close(j, up);
  }
  for (std::size_t j = 0; j < sums.size(); ++j) {
    const int up = tree.parent[j];
    if (up >= 0) sums[static_cast<std::size_t>(up)] += sums[j];
    sums[j] -= weights[j];
  }
  return sums;
}

}  // namespace quiver
