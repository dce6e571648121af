#include <quiver/solvers/cholesky/task_schedule.h>

#include <algorithm>
#include <queue>

namespace quiver::detail {
namespace {

/// Below this much work a second thread costs more than it brings.
constexpr double smallestSharedNanoseconds = 6e4;
/// How well a large front is divided.
constexpr double frontEfficiency = 0.9;
constexpr int mostSplitsPerThread = 48;

using Task = TaskSchedule::Task;

bool cheaper(const Task& a, const Task& b) { return a.cost != b.cost ? a.cost < b.cost : a.begin > b.begin; }

/// The time of the longest thread when each takes the dearest task left.
double makespan(std::vector<Task> tasks, int threads) {
  std::ranges::sort(tasks, [](const Task& a, const Task& b) { return cheaper(b, a); });
  std::priority_queue<double, std::vector<double>, std::greater<>> finish;
  for (int t = 0; t < threads; ++t) finish.push(0.0);
  double last = 0.0;
  for (const Task& task : tasks) {
    const double end = finish.top() + task.cost;
    finish.pop();
    finish.push(end);
    last = std::max(last, end);
  }
  return last;
}

}  // namespace

bool isLargeFront(const TreeNode& node) {
  const double columns = node.columns;
  const double order = columns + node.rows;
  return !node.leaf && columns * order * order > 3e5;
}

TaskSchedule::TaskSchedule(std::span<const TreeNode> nodes, int wanted) {
  const int count = static_cast<int>(nodes.size());
  if (count == 0) return;
  std::vector<double> subtreeCost(nodes.size());
  std::vector<int> subtreeBegin(nodes.size());
  double total = 0.0;
  for (int k = 0; k < count; ++k) subtreeBegin[k] = k;
  for (int k = 0; k < count; ++k) {
    subtreeCost[k] += nodes[k].cost;
    total += nodes[k].cost;
    const int up = nodes[k].parent;
    if (up < 0) continue;
    subtreeCost[up] += subtreeCost[k];
    subtreeBegin[up] = std::min(subtreeBegin[up], subtreeBegin[k]);
  }
  if (wanted <= 1 || total < smallestSharedNanoseconds) {
    tasks.push_back({0, count, total});
    return;
  }
  threads = wanted;
  const auto taskOf = [&](int root) { return Task{subtreeBegin[root], root + 1, subtreeCost[root]}; };
  std::vector<Task> heap;
  for (int k = 0; k < count; ++k) {
    if (nodes[k].parent < 0) heap.push_back(taskOf(k));
  }
  std::ranges::make_heap(heap, cheaper);
  double topCost = 0.0;
  std::vector<Task> best = heap;
  double bestTime = makespan(heap, threads);
  for (int split = 0; split < mostSplitsPerThread * threads && !heap.empty(); ++split) {
    std::ranges::pop_heap(heap, cheaper);
    const int root = heap.back().end - 1;
    heap.pop_back();
    const TreeNode& node = nodes[root];
    topCost += isLargeFront(node) ? node.cost / (threads * frontEfficiency) : node.cost;
    if (topCost >= bestTime) break;
    // Children are the roots met when whole subtrees are skipped from the right.
    for (int child = root - 1; child >= subtreeBegin[root]; child = subtreeBegin[child] - 1) {
      heap.push_back(taskOf(child));
      std::ranges::push_heap(heap, cheaper);
    }
    const double time = topCost + makespan(heap, threads);
    if (time < bestTime) {
      bestTime = time;
      best = heap;
    }
  }
  std::ranges::sort(best, [](const Task& a, const Task& b) { return cheaper(b, a); });
  tasks = std::move(best);
  std::vector<char> covered(nodes.size(), 0);
  for (const Task& task : tasks) std::fill(covered.begin() + task.begin, covered.begin() + task.end, char{1});
  for (int k = 0; k < count; ++k) {
    if (covered[k] == 0) top.push_back(k);
  }
}

}  // namespace quiver::detail
