#pragma once

#include <span>
#include <vector>

#include <quiver/solvers/cholesky/node_tree.h>

namespace quiver::detail {

/// Who computes what when: subtrees that run side by side, then the nodes above them one after the other, each of those
/// divided among the threads inside if it is large. What is computed does not depend on it, only when.
struct TaskSchedule {
  /// Postorder ranges of nodes [begin, end): whole subtrees (or forests), dearest first.
  struct Task {
    int begin = 0;
    int end = 0;
    double cost = 0.0;
  };
  std::vector<Task> tasks;
  /// Nodes above the tasks, in postorder.
  std::vector<int> top;
  /// 1 if the whole work is too small to be shared.
  int threads = 1;

  TaskSchedule() = default;
  TaskSchedule(std::span<const TreeNode> nodes, int threads);
};

/// Whether a front is worth being divided among threads.
bool isLargeFront(const TreeNode& node);

}  // namespace quiver::detail
