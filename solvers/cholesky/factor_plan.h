#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <quiver/solvers/block/factor_pattern.h>
#include <quiver/solvers/cholesky/kernels/kernel_table.h>
#include <quiver/solvers/cholesky/node_tree.h>
#include <quiver/solvers/cholesky/task_schedule.h>

namespace quiver::detail {

/// Consecutive scalars in the factor's numbering.
struct ScalarSpan {
  std::int32_t begin;
  std::int32_t length;
};

/// Storage of a node, and where its lists begin (they end where the next node's begin). A front's panel is
/// `paddedColumns` + `paddedRows` rows of which the first TreeNode::columns and the next TreeNode::rows count; offsets
/// are in doubles.
struct NodeStorage {
  int scalar = 0;  // first scalar of its columns, in the factor's numbering
  int paddedColumns = 0;
  int paddedRows = 0;
  std::int64_t values = 0;
  std::int64_t stride = 0;  // of a front's panel
  std::int64_t update = 0;  // of its update matrix, in the arena or (below a task's root) in the worker's part of it
  std::int64_t updateCount = 0;  // doubles of the update matrix; a leaf subtree's panel follows
  std::int64_t panelCount = 0;
  UpdateLayout updateLayout{};
  std::int64_t vector = 0;  // of its part of the substitution, in the workspace
  std::int64_t children = 0;
  std::int64_t runs = 0;
  std::int64_t spans = 0;
  std::int64_t leafColumns = 0;
  std::int64_t panels = 0;
  int outside = 0;            // block rows below a leaf subtree
  bool sharedUpdate = false;  // a task's root, or a node above the tasks
};

/// Everything about the factorisation of one pattern that does not depend on numbers: computed once, then only read.
///
/// The factor's numbering is a renumbering of the pattern's that keeps ancestors after descendants; H's blocks keep
/// their orientation.
class FactorPlan {
 public:
  FactorPlan() = default;
  /// O(blocks of L + products of leaf blocks). Throws LogicError beyond 2³¹ scalars in one front or in the system.
  FactorPlan(const BlockPattern& pattern, int threads);

  /// The dimension of all blocks if there are leaf subtrees.
  int leafDimension = 0;
  /// The dimension of all blocks, 0 if they differ.
  int uniformDimension = 0;
  FactorSize size;
  std::vector<TreeNode> nodes;
  /// One more than nodes; the last one closes the lists.
  std::vector<NodeStorage> storage;
  TaskSchedule schedule;

  /// Block of the pattern that is the i-th in the factor's numbering, its first scalar there and in the pattern.
  std::vector<int> blocks;
  std::vector<int> blockScalar;  // one more: the number of scalars
  std::vector<std::int64_t> patternScalar;
  /// loads of block column i: [loadBegin[i], loadBegin[i + 1]), destinations ascending, so the diagonal block first.
  std::vector<std::int64_t> loadBegin;
  std::vector<LoadEntry> loads;

  std::vector<int> children;      // node indices, ascending
  std::vector<RowRun> runs;       // of each node's rows in its parent's storage
  std::vector<ScalarSpan> spans;  // of each node's rows
  std::vector<LeafColumn> leafColumns;
  std::vector<std::int32_t> leafRows;
  std::vector<std::int32_t> leafPositions;
  std::vector<LeafPanel> panels;
  std::vector<RowRun> panelRuns;
  std::unique_ptr<std::int32_t[]> leafDestinations;
  std::int64_t leafDestinationCount = 0;

  std::int64_t valueCount = 0;
  /// The arena begins with a part for each of `workers` threads; what lives longer follows, and when the tasks are done
  /// the nodes above them use it all.
  int workers = 0;
  std::int64_t workerArena = 0;
  std::int64_t arenaCount = 0;
  std::int64_t workspaceCount = 0;
  /// Bytes of all lists.
  std::int64_t bytes() const;

  std::span<const int> childrenOf(int node) const {
    return {children.data() + storage[node].children, children.data() + storage[node + 1].children};
  }
  std::span<const RowRun> runsOf(int node) const {
    return {runs.data() + storage[node].runs, runs.data() + storage[node + 1].runs};
  }
  std::span<const ScalarSpan> spansOf(int node) const {
    return {spans.data() + storage[node].spans, spans.data() + storage[node + 1].spans};
  }
  LeafView leafOf(int node) const {
    return {leafColumns.data() + storage[node].leafColumns,
            nodes[node].lastBlock - nodes[node].firstBlock,
            storage[node].outside,
            leafRows.data(),
            leafPositions.data(),
            leafDestinations.get(),
            panels.data() + storage[node].panels,
            panelRuns.data()};
  }
};

}  // namespace quiver::detail
