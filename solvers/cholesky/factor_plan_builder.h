#pragma once

#include <memory>
#include <span>
#include <vector>

#include <quiver/solvers/cholesky/factor_plan.h>

namespace quiver::detail {

/// The steps of FactorPlan's construction, in the order they run.
class FactorPlanBuilder {
 public:
  FactorPlanBuilder(FactorPlan& plan, const BlockPattern& pattern, int threads);

 private:
  /// Elimination tree, postorder, structure of L, nodes.
  void analyzeStructure(int threads);
  void numberScalars();
  /// The blocks below a column of the factor's numbering, ascending, as positions of the elimination order.
  std::span<const int> below(int column) const { return factor_->column(tree_->order[column]); }
  /// In the factor's numbering: rows below a node.
  std::span<const int> rowsBelow(int node) const { return below(plan_.nodes[node].lastBlock - 1); }
  int dimension(int position) const { return dimensions_[position]; }

  void layOutNodes();
  UpdateLayout updateLayoutOf(const TreeNode& node) const;
  void listChildren();
  void addRuns(int node);
  void addSpans(int node);
  void layOutLeaf(int node, NodeStorage& storage);
  void addLeafColumn(int node, int column, std::int32_t& offset);
  void listDestinations();
  void addLeafDestinations(int node, const int* targets);
  void listLoads();
  void listNodeLoads(int node, const std::vector<int>& place, const std::vector<std::int64_t>& source);
  void placeUpdates();

  FactorPlan& plan_;
  const BlockPattern& pattern_;
  std::vector<int> order_;       // elimination order: a postorder of the pattern's
  std::vector<int> dimensions_;  // in elimination order
  std::unique_ptr<FactorPattern> factor_;
  std::unique_ptr<NodeTree> tree_;
  int threads_;
  std::vector<int> scratch_;
  std::vector<int> targets_;  // of all leaves' blocks inside them: the column, counted from the leaf's first
  std::vector<std::int64_t> targetBegin_;  // of each node
  std::int64_t destinations_ = 0;
};

}  // namespace quiver::detail
