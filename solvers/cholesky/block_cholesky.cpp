#include <quiver/solvers/cholesky/block_cholesky.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/solvers/backends/validate.h>
#include <quiver/solvers/cholesky/panel.h>
#include <quiver/solvers/cholesky/work_buffer.h>

namespace quiver::detail {
namespace {

/// Scalar columns of a front that are assembled together.
constexpr int assemblyColumns = 48;
/// Right-hand sides that go through the factor together: each node is read from far memory once for all of them.
constexpr int columnsTogether = 4;
/// Doubles of the next node that are fetched beforehand: a part of the second cache.
constexpr std::int64_t mostUpcoming = 65536;

/// Copies blocks to their destinations; b is their common dimension, 0 if it is known at run time only.
template <int b>
void copyBlocks(const LoadEntry* entry, const LoadEntry* end, const double* source, double* values,
                std::int64_t stride) {
  for (; entry != end; ++entry) {
    const int rows = b > 0 ? b : entry->rows;
    const int columns = b > 0 ? b : entry->columns;
    const double* from = source + entry->source;
    double* to = values + entry->destination;
    for (int c = 0; c < columns; ++c, from += rows, to += stride) {
      for (int r = 0; r < rows; ++r) to[r] = from[r];
    }
  }
}

/// Calls visit(dimension, first scalar in the factor's numbering, first scalar in the pattern's) for every block; the
/// usual dimensions are constants of the type.
template <typename Visit>
void forEachBlock(const FactorPlan& plan, const Visit& visit) {
  const auto visitAll = [&](const auto& dimensionOf) {
    for (std::size_t i = 0; i < plan.blocks.size(); ++i)
      visit(dimensionOf(i), plan.blockScalar[i], plan.patternScalar[i]);
  };
  switch (plan.uniformDimension) {
    case 3:
      return visitAll([](std::size_t) { return std::integral_constant<int, 3>(); });
    case 6:
      return visitAll([](std::size_t) { return std::integral_constant<int, 6>(); });
    default:
      return visitAll([&](std::size_t i) { return plan.blockScalar[i + 1] - plan.blockScalar[i]; });
  }
}

}  // namespace

BlockCholesky::BlockCholesky(KernelLevel level) : kernels_(kernelTable(level)) {}

void BlockCholesky::analyze(std::shared_ptr<const BlockPattern> pattern, int threads) {
  factored_ = false;
  const bool same = pattern_ != nullptr && threads == threads_ && (pattern == pattern_ || *pattern == *pattern_);
  if (same) {
    pattern_ = std::move(pattern);
    return;
  }
  pattern_ = nullptr;  // unless all of this succeeds
  plan_ = FactorPlan(*pattern, threads);
  reserve(values_, plan_.valueCount + 8);
  reserve(inverse_, pattern->layout().scalars());
  reserve(arena_, plan_.arenaCount + 8);
  columnCount_ = workspaceOf(plan_, *pattern);
  reserve(workspace_, columnsTogether * columnCount_);
  failures_.assign(plan_.schedule.tasks.size(), {});
  threads_ = threads;
  pattern_ = std::move(pattern);
}

std::int64_t BlockCholesky::workspaceOf(const FactorPlan& plan, const BlockPattern& pattern) {
  return (plan.workspaceCount + pattern.layout().scalars() + 7) / 8 * 8;
}

std::int64_t BlockCholesky::predictBytes(const BlockPattern& pattern, int threads) {
  const FactorPlan plan(pattern, threads);
  const std::int64_t doubles = plan.valueCount + pattern.layout().scalars() + plan.arenaCount + 16 +
                               columnsTogether * workspaceOf(plan, pattern);
  return doubles * 8 + plan.bytes();
}

FactorStatistics BlockCholesky::statistics() const {
  const std::int64_t doubles = values_.size() + inverse_.size() + arena_.size() + workspace_.size();
  return {plan_.size.nonzeros, plan_.size.flops, doubles * 8 + plan_.bytes(), 0};
}

SolverStatus BlockCholesky::factorize(const BlockMatrix& matrix, std::span<const double> damping,
                                      const StopCondition& stop) {
  validateFactorize(name(), pattern_.get(), matrix, damping);
  return factorAll({matrix.values().data(), damping.empty() ? nullptr : damping.data(), &stop, false});
}

SolverStatus BlockCholesky::factorizeAndSolve(const BlockMatrix& matrix, std::span<const double> damping,
                                              std::span<double> rightHandSide, const StopCondition& stop) {
  validateFactorize(name(), pattern_.get(), matrix, damping);
  validateSolve(name(), true, pattern_.get(), rightHandSide, 1);
  loadVector(rightHandSide.data(), columnOf(0).x);
  const SolverStatus status =
      factorAll({matrix.values().data(), damping.empty() ? nullptr : damping.data(), &stop, true});
  if (!status.ok()) return status;
  const Stopwatch watch;
  backwardAll(1);
  storeVector(columnOf(0).x, rightHandSide.data());
  solveSeconds_ = watch.seconds();
  return status;
}

SolverStatus BlockCholesky::factorAll(const Input& input) {
  factored_ = false;
  const StopCondition& stop = *input.stop;
  const TaskSchedule& schedule = plan_.schedule;
  std::atomic<bool> stopped{false};
  const auto count = static_cast<std::int64_t>(schedule.tasks.size());
  parallelForWorkers(count, plan_.workers, schedule.threads, [&](std::int64_t t, int worker) {
    failures_[t] = factorTask(t, input, arena_.data() + worker * plan_.workerArena, stopped);
  });
  if (stopped || stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
  // The first in the factor's numbering, whichever task met it first.
  const Failure* first = nullptr;
  for (const Failure& failure : failures_) {
    if (failure.scalar >= 0 && (first == nullptr || failure.scalar < first->scalar)) first = &failure;
  }
  if (first != nullptr) return statusOf(*first);
  for (const int node : schedule.top) {
    if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
    UpcomingMemory none{};  // threads share the node
    const Failure failure =
        factorNode(node, input, {isLargeFront(plan_.nodes[node]) ? schedule.threads : 1, nullptr, none});
    if (failure.scalar >= 0) return statusOf(failure);
  }
  if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
  factored_ = true;
  return {};
}

SolverStatus BlockCholesky::statusOf(const Failure& failure) const {
  const auto after = std::upper_bound(plan_.blockScalar.begin(), plan_.blockScalar.end(), failure.scalar);
  const auto column = after - plan_.blockScalar.begin() - 1;
  const auto coordinate = static_cast<int>(failure.scalar - plan_.blockScalar[column]);
  return {SolverStatus::Outcome::notPositiveDefinite, plan_.blocks[column], coordinate, failure.pivot};
}

BlockCholesky::Failure BlockCholesky::factorTask(std::int64_t task, const Input& input, double* arena,
                                                 std::atomic<bool>& stopped) {
  const auto& [begin, end, cost] = plan_.schedule.tasks[task];
  Failure failure;
  for (int node = begin; node < end && failure.scalar < 0; ++node) {
    if (stopped.load(std::memory_order_relaxed)) break;
    if (input.stop->reached()) stopped = true;
    UpcomingMemory upcoming = upcomingAfter(node, end);
    failure = factorNode(node, input, {1, arena, upcoming});
  }
  return failure;
}

UpcomingMemory BlockCholesky::upcomingAfter(int node, int end) {
  if (node + 1 >= end) return {};
  const std::int64_t first = plan_.storage[node + 1].values;
  const double* const begin = values_.data() + first;
  return {begin, begin + std::min(mostUpcoming, plan_.storage[node + 2].values - first)};
}

BlockCholesky::Failure BlockCholesky::factorNode(int node, const Input& input, const Worker& worker) {
  const Failure failure = plan_.nodes[node].leaf ? factorLeaf(node, input, worker) : factorFront(node, input, worker);
  if (input.substitutes && failure.scalar < 0) forwardNode(node, columnOf(0));
  return failure;
}

/// Copies the blocks of H in the given columns into a front's panel.
void BlockCholesky::loadColumns(int node, const Input& input, int firstBlock, int lastBlock) {
  const std::int64_t stride = plan_.storage[node].stride;
  double* values = values_.data() + plan_.storage[node].values;
  const LoadEntry* begin = plan_.loads.data() + plan_.loadBegin[firstBlock];
  const LoadEntry* end = plan_.loads.data() + plan_.loadBegin[lastBlock];
  switch (plan_.uniformDimension) {
    case 3:
      return copyBlocks<3>(begin, end, input.values, values, stride);
    case 6:
      return copyBlocks<6>(begin, end, input.values, values, stride);
    default:
      return copyBlocks<0>(begin, end, input.values, values, stride);
  }
}

void BlockCholesky::addDamping(int node, const Input& input, int firstBlock, int lastBlock, std::int64_t stride) {
  if (input.damping == nullptr) return;
  double* values = values_.data() + plan_.storage[node].values;
  for (int column = firstBlock; column < lastBlock; ++column) {
    const LoadEntry& entry = plan_.loads[plan_.loadBegin[column]];
    double* diagonal = values + entry.destination;
    const double* damping = input.damping + plan_.patternScalar[column];
    for (int c = 0; c < entry.columns; ++c) diagonal[c * (stride + 1)] += damping[c];
  }
}

BlockCholesky::Failure BlockCholesky::factorLeaf(int node, const Input& input, const Worker& worker) {
  const TreeNode& leaf = plan_.nodes[node];
  const NodeStorage& storage = plan_.storage[node];
  double* values = values_.data() + storage.values;
  double* update = updateOf(node, worker);
  const int b = plan_.leafDimension;
  std::memset(update, 0, static_cast<std::size_t>(storage.updateCount) * sizeof(double));
  kernels_.leafLoad[b](plan_.leafOf(node), plan_.loads.data(), plan_.loadBegin.data() + leaf.firstBlock, input.values,
                       values);
  addDamping(node, input, leaf.firstBlock, leaf.lastBlock, leafStride(b));
  double pivot = 0.0;
  const int failed =
      kernels_.leafFactor[b](plan_.leafOf(node), values, inverse_.data() + storage.scalar,
                             {update, storage.updateLayout, update + storage.updateCount}, &pivot, &worker.upcoming);
  return failed < 0 ? Failure{} : Failure{storage.scalar + failed, pivot};
}

BlockCholesky::Failure BlockCholesky::factorFront(int node, const Input& input, const Worker& worker) {
  const TreeNode& front = plan_.nodes[node];
  const int threads = worker.threads;
  if (threads <= 1) {
    assemblePanel(node, input, worker, front.firstBlock, front.lastBlock);
  } else {
    const int blocks = front.lastBlock - front.firstBlock;
    const int parts = std::max(1, front.columns / assemblyColumns);
    parallelFor(parts, threads, [&](std::int64_t p) {
      const auto border = [&](std::int64_t part) { return front.firstBlock + static_cast<int>(part * blocks / parts); };
      assemblePanel(node, input, worker, border(p), border(p + 1));
    });
  }
  const NodeStorage& storage = plan_.storage[node];
  const Panel panel{values_.data() + storage.values, storage.stride, front.columns,
                    storage.paddedColumns + storage.paddedRows, inverse_.data() + storage.scalar};
  const PanelFailure failure = factorPanel(kernels_, panel, threads, *input.stop, worker.upcoming);
  if (failure.column >= 0) return {storage.scalar + failure.column, failure.pivot};
  if (failure.stopped || front.rows == 0) return {};
  const int width = storage.updateLayout.width;
  parallelFor((front.rows + width - 1) / width, threads,
              [&](std::int64_t strip) { formUpdate(node, worker, static_cast<int>(strip)); });
  return {};
}

/// The given block columns of a front: zero, plus H, plus what the children pass up.
void BlockCholesky::assemblePanel(int node, const Input& input, const Worker& worker, int firstBlock, int lastBlock) {
  const NodeStorage& storage = plan_.storage[node];
  double* panel = values_.data() + storage.values;
  const int begin = plan_.blockScalar[firstBlock] - storage.scalar;
  const int end = plan_.blockScalar[lastBlock] - storage.scalar;
  std::memset(panel + begin * storage.stride, 0,
              static_cast<std::size_t>((end - begin) * storage.stride) * sizeof(double));
  loadColumns(node, input, firstBlock, lastBlock);
  addDamping(node, input, firstBlock, lastBlock, storage.stride);
  for (const int child : plan_.childrenOf(node)) {
    const std::span<const RowRun> runs = plan_.runsOf(child);
    kernels_.addChild(updateOf(child, worker), plan_.storage[child].updateLayout, runs.data(),
                      static_cast<int>(runs.size()), panel, storage.stride, 0, begin, end);
  }
}

/// A strip of the update matrix: made from the panel's rows below, then, while still near, the children's parts are
/// added.
void BlockCholesky::formUpdate(int node, const Worker& worker, int strip) {
  const TreeNode& front = plan_.nodes[node];
  const NodeStorage& storage = plan_.storage[node];
  const UpdateLayout layout = storage.updateLayout;
  const int begin = strip * layout.width;
  const int end = std::min(begin + layout.width, front.rows);
  const int shift = storage.paddedColumns + begin;
  const double* below = values_.data() + storage.values + shift;
  double* update = updateOf(node, worker) + stripBegin(layout, strip);
  kernels_.formUpdate(update, stripStride(layout, strip), below, storage.stride, front.columns, end - begin,
                      storage.paddedRows - begin, &worker.upcoming);
  for (const int child : plan_.childrenOf(node)) {
    const std::span<const RowRun> runs = plan_.runsOf(child);
    kernels_.addChild(updateOf(child, worker), plan_.storage[child].updateLayout, runs.data(),
                      static_cast<int>(runs.size()), update, stripStride(layout, strip), shift, shift,
                      shift + end - begin);
  }
}

SolverStatus BlockCholesky::solve(std::span<double> rightHandSides, int count) {
  validateSolve(name(), factored_, pattern_.get(), rightHandSides, count);
  const std::int64_t scalars = pattern_->layout().scalars();
  for (int k = 0; k < count; k += columnsTogether) {
    solveTogether(rightHandSides.data() + k * scalars, std::min(columnsTogether, count - k));
  }
  return {};
}

BlockCholesky::Column BlockCholesky::columnOf(int index) {
  double* workspace = workspace_.data() + index * columnCount_;
  return {workspace + plan_.workspaceCount, workspace};
}

void BlockCholesky::solveTogether(double* b, int count) {
  const std::int64_t scalars = pattern_->layout().scalars();
  for (int k = 0; k < count; ++k) loadVector(b + k * scalars, columnOf(k).x);
  forwardAll(count);
  backwardAll(count);
  for (int k = 0; k < count; ++k) storeVector(columnOf(k).x, b + k * scalars);
}

void BlockCholesky::forwardAll(int count) {
  const TaskSchedule& schedule = plan_.schedule;
  const auto forward = [&](int node) {
    for (int k = 0; k < count; ++k) forwardNode(node, columnOf(k));
  };
  parallelFor(static_cast<std::int64_t>(schedule.tasks.size()), schedule.threads, [&](std::int64_t t) {
    for (int node = schedule.tasks[t].begin; node < schedule.tasks[t].end; ++node) forward(node);
  });
  for (const int node : schedule.top) forward(node);
}

void BlockCholesky::backwardAll(int count) {
  const TaskSchedule& schedule = plan_.schedule;
  const auto backward = [&](int node) {
    for (int k = 0; k < count; ++k) backwardNode(node, columnOf(k));
  };
  for (std::size_t i = schedule.top.size(); i-- > 0;) backward(schedule.top[i]);
  parallelFor(static_cast<std::int64_t>(schedule.tasks.size()), schedule.threads, [&](std::int64_t t) {
    for (int node = schedule.tasks[t].end - 1; node >= schedule.tasks[t].begin; --node) backward(node);
  });
}

void BlockCholesky::loadVector(const double* b, double* x) const {
  forEachBlock(plan_, [&](const auto size, std::int64_t first, std::int64_t place) {
    for (int c = 0; c < size; ++c) x[first + c] = b[place + c];
  });
}

void BlockCholesky::storeVector(const double* x, double* b) const {
  forEachBlock(plan_, [&](const auto size, std::int64_t first, std::int64_t place) {
    for (int c = 0; c < size; ++c) b[place + c] = x[first + c];
  });
}

/// y = L⁻¹ b in the node's columns; what the rows below lose stays in the node's part of the workspace, for the parent.
void BlockCholesky::forwardNode(int node, const Column& column) {
  const TreeNode& front = plan_.nodes[node];
  const NodeStorage& storage = plan_.storage[node];
  double* v = column.workspace + storage.vector;
  double* x = column.x + storage.scalar;
  if (front.leaf) {
    kernels_.leafForward[plan_.leafDimension](plan_.leafOf(node), values_.data() + storage.values,
                                              inverse_.data() + storage.scalar, x, v + storage.paddedRows, v);
    return;
  }
  std::memset(v, 0, static_cast<std::size_t>(storage.paddedColumns + storage.paddedRows) * sizeof(double));
  std::copy(x, x + front.columns, v);
  for (const int child : plan_.childrenOf(node)) {
    const double* passed = column.workspace + plan_.storage[child].vector + plan_.storage[child].paddedColumns;
    for (const RowRun& run : plan_.runsOf(child)) {
      for (int i = 0; i < run.length; ++i) v[run.destination + i] += passed[run.source + i];
    }
  }
  kernels_.forward(values_.data() + storage.values, storage.stride, front.columns,
                   storage.paddedColumns + storage.paddedRows, inverse_.data() + storage.scalar, v);
  std::copy(v, v + front.columns, x);
}

void BlockCholesky::backwardNode(int node, const Column& column) {
  const TreeNode& front = plan_.nodes[node];
  const NodeStorage& storage = plan_.storage[node];
  double* v = column.workspace + storage.vector;
  double* x = column.x + storage.scalar;
  if (front.leaf) {
    const int b = plan_.leafDimension;
    double* subtree = v + storage.paddedRows;
    const int place = leafPlace(b);
    double* outside = subtree + front.columns / b * place;
    for (const ScalarSpan& span : plan_.spansOf(node)) {
      for (int i = 0; i < span.length; i += b, outside += place)
        std::fill(std::copy_n(column.x + span.begin + i, b, outside), outside + place, 0.0);
    }
    kernels_.leafBackward[b](plan_.leafOf(node), values_.data() + storage.values, inverse_.data() + storage.scalar, x,
                             subtree);
    return;
  }
  std::copy(x, x + front.columns, v);
  double* below = v + storage.paddedColumns;
  for (const ScalarSpan& span : plan_.spansOf(node)) {
    std::copy(column.x + span.begin, column.x + span.begin + span.length, below);
    below += span.length;
  }
  // Padding meets zeros of the panel, but must be finite.
  std::fill(v + front.columns, v + storage.paddedColumns, 0.0);
  std::fill(below, v + storage.paddedColumns + storage.paddedRows, 0.0);
  kernels_.backward(values_.data() + storage.values, storage.stride, front.columns,
                    storage.paddedColumns + storage.paddedRows, inverse_.data() + storage.scalar, v);
  std::copy(v, v + front.columns, x);
}

}  // namespace quiver::detail
