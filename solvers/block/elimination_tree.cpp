#include <quiver/solvers/block/elimination_tree.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace quiver {
BlockGraph::BlockGraph(const BlockPattern& pattern) {
  const int count = pattern.blocks();
  starts.assign(static_cast<std::size_t>(count) + 1, 0);
  for (int column = 0; column < count; ++column) {
    starts[static_cast<std::size_t>(column) + 1] += pattern.columnEnd(column) - pattern.columnBegin(column) - 1;
    for (std::int64_t k = pattern.columnBegin(column) + 1; k < pattern.columnEnd(column); ++k)
      ++starts[static_cast<std::size_t>(pattern.row(k)) + 1];
  }
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  neighbours.resize(static_cast<std::size_t>(starts.back()));
  std::vector<std::int64_t> next(starts.begin(), starts.end() - 1);
  // Two passes keep every list ascending: smaller neighbours come from the columns before, larger ones from the own
  // column.
  for (int column = 0; column < count; ++column) {
    for (std::int64_t k = pattern.columnBegin(column) + 1; k < pattern.columnEnd(column); ++k) {
      neighbours[static_cast<std::size_t>(next[static_cast<std::size_t>(pattern.row(k))]++)] = column;
    }
  }
  middles = std::move(next);
  for (int column = 0; column < count; ++column) {
    int* out = neighbours.data() + middles[static_cast<std::size_t>(column)];
    for (std::int64_t k = pattern.columnBegin(column) + 1; k < pattern.columnEnd(column); ++k) *out++ = pattern.row(k);
  }
}

std::vector<int> positionsOf(std::span<const int> order) {
  std::vector<int> position(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) position[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  return position;
}

OrderedGraph::OrderedGraph(const BlockGraph& graph, std::span<const int> order) : graph_(graph), order_(order) {
  for (std::size_t i = 0; i < order.size(); ++i) natural_ = natural_ && order[i] == static_cast<int>(i);
  if (!natural_) position_ = positionsOf(order);
}

EliminationTree::EliminationTree(const BlockGraph& graph, std::span<const int> order) : parent(order.size(), -1) {
  const OrderedGraph ordered(graph, order);
  std::vector<int> ancestor(order.size(), -1);  // the highest known ancestor, for path compression
  for (int i = 0; i < static_cast<int>(order.size()); ++i) {
    ordered.forEachBefore(i, [i, up = parent.data(), highest = ancestor.data()](int j) {
      for (int next = highest[j]; next != i; j = next, next = highest[j]) {
        highest[j] = i;
        if (next >= 0) continue;
        up[j] = i;
        break;
      }
    });
  }
}

bool isPostordered(std::span<const int> parent) {
  std::vector<int> size(parent.size(), 1);
  for (std::size_t j = 0; j < parent.size(); ++j) {
    if (parent[j] >= 0) size[static_cast<std::size_t>(parent[j])] += size[j];
  }
  // Every subtree in a run as long as its root's has room for exactly those that belong there.
  for (std::size_t j = 0; j < parent.size(); ++j) {
    const int up = parent[j];
    if (up >= 0 && static_cast<int>(j) - size[j] < up - size[static_cast<std::size_t>(up)]) return false;
  }
  return true;
}

std::vector<int> postorder(std::span<const int> parent, std::span<const double> weight) {
  const std::size_t count = parent.size();
  std::vector<int> sorted(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  if (!weight.empty()) {
    std::stable_sort(sorted.begin(), sorted.end(), [&](int a, int b) {
      return weight[static_cast<std::size_t>(a)] < weight[static_cast<std::size_t>(b)];
    });
  }
  // Lists of children, first child first: heads are pushed from the last to the first.
  std::vector<int> firstChild(count + 1, -1);
  std::vector<int> nextSibling(count, -1);
  for (std::size_t k = count; k-- > 0;) {
    const int node = sorted[k];
    const int up = parent[static_cast<std::size_t>(node)];
    int& head = firstChild[up < 0 ? count : static_cast<std::size_t>(up)];
    nextSibling[static_cast<std::size_t>(node)] = head;
    head = node;
  }
  std::vector<int> result;
  result.reserve(count);
  int node = firstChild[count];
  while (node >= 0) {
    while (firstChild[static_cast<std::size_t>(node)] >= 0) {  // down to the first leaf, forgetting the edges walked
      const int child = firstChild[static_cast<std::size_t>(node)];
      firstChild[static_cast<std::size_t>(node)] = -1;
      node = child;
    }
    while (node >= 0) {
      result.push_back(node);
      if (nextSibling[static_cast<std::size_t>(node)] >= 0) {
        node = nextSibling[static_cast<std::size_t>(node)];
        break;
      }
      node = parent[static_cast<std::size_t>(node)];
    }
  }
  return result;
}

}  // namespace quiver
