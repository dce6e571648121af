#include <quiver/solvers/cholesky/node_tree.h>

#include <algorithm>
#include <limits>
#include <queue>

#include <quiver/solvers/cholesky/cost_model.h>
#include <quiver/solvers/cholesky/kernels/kernel_table.h>

namespace quiver::detail {
namespace {

/// A leaf subtree should fit into a second-level cache; its doubles.
constexpr double largestLeafValues = 2.0 * 1024 * 1024 / 8;
/// A leaf subtree is one thread's: this share of the work at most, where there is work for several.
constexpr double largestLeafShare = 0.45;
constexpr double leastSharedNanoseconds = 6e4;

/// Block columns with one structure: [first, last] in elimination order.
struct Supernode {
  int first = 0;
  int last = 0;
  int parent = -1;
  double columns = 0.0;  // scalars
  double rows = 0.0;
  // Of the subtree as one leaf, and of the best way to do it.
  double leafCost = 0.0;
  double leafValues = 0.0;
  double bestCost = 0.0;
  int firstDescendant = 0;  // block column
  bool asLeaf = false;
};

int uniformDimension(const std::vector<int>& dimensions) {
  const bool uniform =
      !dimensions.empty() && std::ranges::all_of(dimensions, [&](int d) { return d == dimensions.front(); });
  return uniform && dimensions.front() <= largestLeafDimension ? dimensions.front() : 0;
}

std::vector<Supernode> findSupernodes(const std::vector<int>& parent, const FactorPattern& factor,
                                      const std::vector<int>& dimensions) {
  const int count = static_cast<int>(parent.size());
  std::vector<Supernode> supernodes;
  std::vector<int> owner(parent.size());
  for (int j = 0; j < count; ++j) {
    const bool joins = j > 0 && parent[j - 1] == j && factor.column(j - 1).size() == factor.column(j).size() + 1;
    if (!joins) {
      supernodes.emplace_back();
      supernodes.back().first = supernodes.back().firstDescendant = j;
    }
    Supernode& node = supernodes.back();
    node.last = j;
    node.columns += dimensions[j];
    owner[j] = static_cast<int>(supernodes.size()) - 1;
  }
  const bool uniform = std::ranges::all_of(dimensions, [&](int d) { return d == dimensions[0]; });
  for (Supernode& node : supernodes) {
    const std::span<const int> rows = factor.column(node.last);
    if (uniform) {
      node.rows = static_cast<double>(rows.size()) * dimensions[0];
    } else {
      for (const int row : rows) node.rows += dimensions[row];
    }
    if (parent[node.last] >= 0) node.parent = owner[parent[node.last]];
  }
  return supernodes;
}

/// Bottom-up: is the subtree cheaper as one leaf, of at most `dearestLeaf`, or as a front above its children's best?
/// Returns the cost of everything.
double chooseLeaves(std::vector<Supernode>& supernodes, const FactorPattern& factor, int dimension,
                    double dearestLeaf) {
  for (Supernode& node : supernodes) node.bestCost = node.leafCost = node.leafValues = 0.0;
  double total = 0.0;
  for (std::size_t s = 0; s < supernodes.size(); ++s) {
    Supernode& node = supernodes[s];
    const double front = node.bestCost + frontNanoseconds(node.columns, node.rows);
    node.bestCost = front;
    if (dimension > 0) {
      for (int j = node.first; j <= node.last; ++j) {
        const auto below = static_cast<double>(factor.column(j).size());
        node.leafCost += leafColumnNanoseconds(dimension, below);
        node.leafValues += (below + 1.0) * dimension * leafStride(dimension);
      }
      const double leaf = node.leafCost + leafUpdateNanoseconds(node.rows);
      node.asLeaf = node.leafValues <= largestLeafValues && leaf <= std::min(front, dearestLeaf);
      if (node.asLeaf) node.bestCost = leaf;
    }
    if (node.parent < 0) {
      total += node.bestCost;
      continue;
    }
    Supernode& up = supernodes[node.parent];
    up.bestCost += node.bestCost;
    up.leafCost += node.leafCost;
    up.leafValues += node.leafValues;
    up.firstDescendant = std::min(up.firstDescendant, node.firstDescendant);
  }
  return total;
}

/// For each supernode the one at the top of the leaf subtree it lies in, or −1.
std::vector<int> leafRoots(const std::vector<Supernode>& supernodes) {
  std::vector<int> root(supernodes.size(), -1);
  for (std::size_t s = supernodes.size(); s-- > 0;) {
    const int up = supernodes[s].parent;
    if (up >= 0 && root[up] >= 0) {
      root[s] = root[up];
    } else if (supernodes[s].asLeaf) {
      root[s] = static_cast<int>(s);
    }
  }
  return root;
}

/// Merges fronts into their parents while that saves time. Returns for each supernode the one it ends in; sizes of the
/// survivors are updated.
class Amalgamation {
 public:
  Amalgamation(std::vector<Supernode>& supernodes, const std::vector<int>& leafRoot)
      : supernodes_(supernodes),
        firstChild_(supernodes.size(), -1),
        next_(supernodes.size(), -1),
        into_(supernodes.size(), -1) {
    for (std::size_t s = supernodes.size(); s-- > 0;) {
      const int up = supernodes[s].parent;
      if (up < 0 || leafRoot[s] >= 0) continue;
      next_[s] = firstChild_[up];
      firstChild_[up] = static_cast<int>(s);
    }
    for (std::size_t s = 0; s < supernodes.size(); ++s) {
      if (leafRoot[s] < 0) mergeChildren(static_cast<int>(s));
    }
  }

  std::vector<int> representatives() const {
    std::vector<int> result(into_.size());
    for (std::size_t s = into_.size(); s-- > 0;) result[s] = into_[s] < 0 ? static_cast<int>(s) : result[into_[s]];
    return result;
  }

 private:
  using Candidate = std::pair<double, int>;  // gain, child

  double gain(const Supernode& up, const Supernode& child) const {
    return frontNanoseconds(child.columns, child.rows) + frontNanoseconds(up.columns, up.rows) -
           frontNanoseconds(child.columns + up.columns, up.rows);
  }

  /// Gains shrink as the parent grows, so an outdated gain at the top of the queue is recomputed before it is believed.
  void mergeChildren(int parent) {
    Supernode& up = supernodes_[parent];
    queue_.clear();
    const auto push = [&](int child) {
      const double value = gain(up, supernodes_[child]);
      if (value > 0.0) {
        queue_.emplace_back(value, child);
        std::push_heap(queue_.begin(), queue_.end());
      }
    };
    for (int child = firstChild_[parent]; child >= 0; child = next_[child]) push(child);
    while (!queue_.empty()) {
      std::pop_heap(queue_.begin(), queue_.end());
      const auto [outdated, child] = queue_.back();
      queue_.pop_back();
      const double value = gain(up, supernodes_[child]);
      if (value < outdated && !queue_.empty() && value < queue_.front().first) {
        push(child);
        continue;
      }
      if (value <= 0.0) continue;
      into_[child] = parent;
      up.columns += supernodes_[child].columns;
      int last = -1;
      for (int k = firstChild_[child]; k >= 0; k = next_[k]) {
        push(k);
        last = k;
      }
      if (last >= 0) {
        next_[last] = firstChild_[parent];
        firstChild_[parent] = firstChild_[child];
      }
    }
    removeMerged(parent);
  }

  void removeMerged(int parent) {
    int* link = &firstChild_[parent];
    while (*link >= 0) {
      if (into_[*link] >= 0) {
        *link = next_[*link];
      } else {
        link = &next_[*link];
      }
    }
  }

  std::vector<Supernode>& supernodes_;
  std::vector<int> firstChild_;
  std::vector<int> next_;
  std::vector<int> into_;
  std::vector<Candidate> queue_;
};

/// The order that needs least memory for update matrices: children by falling (peak while working − what remains).
std::vector<double> childWeights(const std::vector<TreeNode>& nodes) {
  std::vector<std::vector<int>> children(nodes.size());
  std::vector<double> peak(nodes.size());
  std::vector<double> weight(nodes.size());
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    std::ranges::stable_sort(children[s], [&](int a, int b) { return weight[a] < weight[b]; });
    double held = 0.0;
    for (const int child : children[s]) {
      peak[s] = std::max(peak[s], held + peak[child]);
      held += static_cast<double>(nodes[child].rows) * nodes[child].rows;
    }
    const double own = static_cast<double>(nodes[s].rows) * nodes[s].rows;
    peak[s] = std::max(peak[s], held + own);
    weight[s] = own - peak[s];
    if (nodes[s].parent >= 0) children[nodes[s].parent].push_back(static_cast<int>(s));
  }
  return weight;
}

/// Columns of a leaf subtree that are factored together, and blocks that are small enough for it: the products of
/// larger ones keep the processor busy.
constexpr int largestGroup = 2;
constexpr int largestGroupedDimension = 3;

/// Appends the columns [first, last] of a leaf subtree by groups of columns none of which waits for another: a pivot is
/// a long chain of operations, and only those of independent columns overlap. Columns that a group makes ready come
/// next, while what they need is near.
void appendInGroups(const std::vector<int>& parent, int first, int last, NodeTree& tree) {
  std::vector<int> waiting(last - first + 1, 0);  // children not yet in the order
  for (int j = first; j < last; ++j) {
    if (parent[j] <= last) ++waiting[parent[j] - first];
  }
  std::vector<int> ready;
  for (int j = last; j >= first; --j) {
    if (waiting[j - first] == 0) ready.push_back(j);
  }
  while (!ready.empty()) {
    const auto size = std::min<std::ptrdiff_t>(std::ssize(ready), largestGroup);
    const auto begin = static_cast<std::ptrdiff_t>(tree.order.size());
    tree.order.insert(tree.order.end(), ready.rbegin(), ready.rbegin() + size);
    tree.groups.resize(tree.order.size(), 0);
    tree.groups[begin] = static_cast<int>(size);
    ready.resize(ready.size() - size);
    for (std::ptrdiff_t i = begin + size; i-- > begin;) {
      const int up = parent[tree.order[i]];
      if (up >= 0 && up <= last && --waiting[up - first] == 0) ready.push_back(up);
    }
  }
}

/// The pieces before they are ordered, children before parents.
struct Pieces {
  std::vector<TreeNode> nodes;
  std::vector<int> top;                   // supernode of each
  std::vector<std::vector<int>> members;  // supernodes of each front
};

/// One piece for each leaf root and each front that is left.
Pieces cutPieces(const std::vector<Supernode>& supernodes, const std::vector<int>& leafRoot,
                 const std::vector<int>& representative) {
  Pieces pieces;
  std::vector<int> nodeOf(supernodes.size(), -1);
  for (std::size_t s = 0; s < supernodes.size(); ++s) {
    const bool survives =
        leafRoot[s] >= 0 ? leafRoot[s] == static_cast<int>(s) : representative[s] == static_cast<int>(s);
    if (!survives) continue;
    nodeOf[s] = static_cast<int>(pieces.top.size());
    pieces.top.push_back(static_cast<int>(s));
  }
  pieces.nodes.resize(pieces.top.size());
  pieces.members.resize(pieces.top.size());
  for (std::size_t s = 0; s < supernodes.size(); ++s) {
    if (leafRoot[s] < 0) pieces.members[nodeOf[representative[s]]].push_back(static_cast<int>(s));
  }
  for (std::size_t k = 0; k < pieces.top.size(); ++k) {
    const Supernode& from = supernodes[pieces.top[k]];
    TreeNode& node = pieces.nodes[k];
    node.leaf = leafRoot[pieces.top[k]] >= 0;
    node.rows = static_cast<int>(from.rows);
    node.parent = from.parent < 0 ? -1 : nodeOf[representative[from.parent]];
    node.cost = node.leaf ? from.bestCost : frontNanoseconds(from.columns, from.rows);
  }
  return pieces;
}

}  // namespace

NodeTree::NodeTree(const std::vector<int>& parent, const FactorPattern& factor, const std::vector<int>& dimensions) {
  std::vector<Supernode> supernodes = findSupernodes(parent, factor, dimensions);
  const int dimension = uniformDimension(dimensions);
  const double total = chooseLeaves(supernodes, factor, dimension, std::numeric_limits<double>::infinity());
  if (total > leastSharedNanoseconds) chooseLeaves(supernodes, factor, dimension, largestLeafShare * total);
  const std::vector<int> leafRoot = leafRoots(supernodes);
  const std::vector<int> representative = Amalgamation(supernodes, leafRoot).representatives();
  const Pieces pieces = cutPieces(supernodes, leafRoot, representative);

  std::vector<int> parents;
  for (const TreeNode& node : pieces.nodes) parents.push_back(node.parent);
  const std::vector<int> visited = postorder(parents, childWeights(pieces.nodes));
  std::vector<int> place(visited.size());
  for (std::size_t k = 0; k < visited.size(); ++k) place[visited[k]] = static_cast<int>(k);
  order.reserve(parent.size());
  for (const int k : visited) {
    TreeNode node = pieces.nodes[k];
    node.parent = node.parent < 0 ? -1 : place[node.parent];
    node.firstBlock = static_cast<int>(order.size());
    const auto append = [&](int first, int last) {
      for (int j = first; j <= last; ++j) order.push_back(j);
    };
    if (node.leaf) {
      const Supernode& root = supernodes[pieces.top[k]];
      if (dimension <= largestGroupedDimension) {
        appendInGroups(parent, root.firstDescendant, root.last, *this);
      } else {
        append(root.firstDescendant, root.last);
        groups.resize(order.size(), 1);
      }
    }
    for (const int s : pieces.members[k]) append(supernodes[s].first, supernodes[s].last);
    groups.resize(order.size(), 0);
    for (std::size_t i = node.firstBlock; i < order.size(); ++i) node.columns += dimensions[order[i]];
    node.lastBlock = static_cast<int>(order.size());
    nodes.push_back(node);
  }
  position.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) position[order[i]] = static_cast<int>(i);
}

}  // namespace quiver::detail
