#include <quiver/solvers/block/factor_pattern.h>

#include <algorithm>

#include <quiver/solvers/block/column_weights.h>

namespace quiver {
namespace {

/// A run of columns that share a list.
struct Chain {
  /// Where its next row goes.
  std::int64_t next;
  int last;
  /// The chain of its last column's parent, and the last row that it was met by.
  int up = -1;
  int met = -1;
};

}  // namespace

FactorSize factorSize(std::span<const int> dimensions, std::span<const std::int64_t> below) {
  FactorSize size;
  for (std::size_t i = 0; i < dimensions.size(); ++i) {
    for (int c = 1; c <= dimensions[i]; ++c) {
      const std::int64_t entries = below[i] + c;
      size.nonzeros += entries;
      size.flops += static_cast<double>(entries) * static_cast<double>(entries);
    }
  }
  return size;
}

FactorSize predictFactor(const BlockPattern& pattern, std::span<const int> order) {
  return predictFactor(BlockGraph(pattern), pattern.layout(), order);
}

FactorSize predictFactor(const BlockGraph& graph, const BlockLayout& layout, std::span<const int> order) {
  std::vector<int> dimensions;
  dimensions.reserve(order.size());
  for (const int block : order) dimensions.push_back(layout.dimension(block));
  return factorSize(dimensions, columnWeights(graph, order, EliminationTree(graph, order), dimensions));
}

FactorPattern::FactorPattern(const BlockGraph& graph, std::span<const int> order, const EliminationTree& tree)
    : begins_(order.size()), counts_(quiver::columnWeights(graph, order, tree, std::vector<int>(order.size(), 1))) {
  const auto count = static_cast<int>(order.size());
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  std::vector<Chain> chains;
  std::vector<int> chainOf(order.size());
  std::int64_t size = 0;
  for (int j = 0; j < count; ++j) {
    // The rows of a column are among those of its parent and the parent itself: as many means all.
    const bool joins = j > 0 && tree.parent[at(j - 1)] == j && counts_[at(j - 1)] == counts_[at(j)] + 1;
    if (!joins) {
      chains.push_back({.next = size, .last = j});
      heads_.push_back(j);
      size += counts_[at(j)];
    }
    chains.back().last = j;
    chainOf[at(j)] = static_cast<int>(chains.size()) - 1;
    begins_[at(j)] = chains.back().next + j - heads_.back();
  }
  rows_.resize(static_cast<std::size_t>(size));
  for (Chain& chain : chains) {
    const int parent = tree.parent[at(chain.last)];
    if (parent >= 0) chain.up = chainOf[at(parent)];
  }
  // Row i of L is the part of the tree that the entries of row i of A reach on their way up to i.
  const OrderedGraph ordered(graph, order);
  for (int i = 0; i < count; ++i) {
    const int own = chainOf[at(i)];
    const auto meet = [i, rows = rows_.data()](Chain& chain) {
      chain.met = i;
      rows[chain.next++] = i;
    };
    if (i > heads_[at(own)]) meet(chains[at(own)]);
    ordered.forEachBefore(i, [&, first = chains.data(), of = chainOf.data()](int j) {
      for (int c = of[j]; c != own && first[c].met != i; c = first[c].up) meet(first[c]);
    });
  }
}

std::vector<std::int64_t> FactorPattern::columnWeights(std::span<const int> weights) const {
  if (!weights.empty() && std::all_of(weights.begin(), weights.end(), [&](int w) { return w == weights[0]; })) {
    std::vector<std::int64_t> sums = counts_;
    for (std::int64_t& sum : sums) sum *= weights[0];
    return sums;
  }
  std::vector<std::int64_t> sums(counts_.size(), 0);
  for (std::size_t c = 0; c < heads_.size(); ++c) {
    const int end = c + 1 < heads_.size() ? heads_[c + 1] : static_cast<int>(counts_.size());
    std::int64_t sum = 0;
    for (const int row : column(heads_[c])) sum += weights[static_cast<std::size_t>(row)];
    for (int j = heads_[c]; j < end; ++j) {
      // Less the column itself, which is the first row of the one before.
      if (j > heads_[c]) sum -= weights[static_cast<std::size_t>(j)];
      sums[static_cast<std::size_t>(j)] = sum;
    }
  }
  return sums;
}

}  // namespace quiver
