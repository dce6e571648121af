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
  void listChildren();
  void addRuns(int node);
  void addSpans(int node);
  void layOutLeaf(int node, NodeStorage& storage);
  void addLeafColumn(int node, int column, std::int32_t& offset);
  void addLeafDestinations(int node, std::int64_t firstColumn);
  void listLoads();
  void placeUpdates();

  FactorPlan& plan_;
  const BlockPattern& pattern_;
  std::vector<int> order_;       // elimination order: a postorder of the pattern's
  std::vector<int> dimensions_;  // in elimination order
  std::unique_ptr<FactorPattern> factor_;
  std::unique_ptr<NodeTree> tree_;
  std::vector<int> scratch_;
  std::vector<int> targets_;  // of a leaf's blocks inside it: the column, counted from its first
};

}  // namespace quiver::detail
