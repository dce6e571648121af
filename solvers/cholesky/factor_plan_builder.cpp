#include <quiver/solvers/cholesky/factor_plan_builder.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>
#include <quiver/solvers/block/ordering.h>
#include <quiver/solvers/cholesky/arena_planner.h>
#include <quiver/solvers/cholesky/leaf_panels.h>

namespace quiver::detail {
namespace {

int ceil8(int value) { return (value + 7) / 8 * 8; }

/// Columns of an update matrix that are stored, and in fronts formed, together.
constexpr int updateColumns = 48;

/// An odd multiple of 8 doubles, so that columns do not fall on the same cache sets.
std::int64_t oddStride(int rows) { return std::int64_t{ceil8(rows) / 8 | 1} * 8; }

[[noreturn]] void refuse(std::int64_t value) {
  throw LogicError(fmt::format("a factor with {} scalars in one piece is too large", value));
}

inline std::int32_t narrow(std::int64_t value) {
  if (value > std::numeric_limits<std::int32_t>::max()) refuse(value);
  return static_cast<std::int32_t>(value);
}

}  // namespace

FactorPlanBuilder::FactorPlanBuilder(FactorPlan& plan, const BlockPattern& pattern, int threads)
    : plan_(plan), pattern_(pattern), threads_(threads) {
  analyzeStructure(threads);
  numberScalars();
  layOutNodes();
  listDestinations();
  listLoads();
  placeUpdates();
}

void FactorPlanBuilder::analyzeStructure(int threads) {
  const BlockGraph graph(pattern_);
  order_ = naturalOrdering(pattern_.blocks()).order;
  EliminationTree tree(graph, order_);
  if (!isPostordered(tree.parent)) {
    std::vector<int> post = postorder(tree.parent);
    // The same tree with its nodes renumbered.
    const std::vector<int> position = positionsOf(post);
    const std::vector<int> parent = std::move(tree.parent);
    tree.parent.assign(post.size(), -1);
    for (std::size_t k = 0; k < post.size(); ++k) {
      if (parent[post[k]] >= 0) tree.parent[k] = position[parent[post[k]]];
    }
    order_ = std::move(post);
  }
  dimensions_.reserve(order_.size());
  for (const int block : order_) dimensions_.push_back(pattern_.layout().dimension(block));
  factor_ = std::make_unique<FactorPattern>(graph, order_, tree);
  plan_.size = factorSize(dimensions_, factor_->columnWeights(dimensions_));
  tree_ = std::make_unique<NodeTree>(tree.parent, *factor_, dimensions_);
  plan_.nodes = tree_->nodes;
  plan_.schedule = TaskSchedule(plan_.nodes, threads);
}

void FactorPlanBuilder::numberScalars() {
  const std::size_t count = order_.size();
  plan_.uniformDimension = pattern_.layout().uniformDimension();
  narrow(pattern_.layout().scalars());
  plan_.blocks.resize(count);
  plan_.blockScalar.resize(count + 1);
  plan_.patternScalar.resize(count);
  int scalar = 0;
  for (std::size_t i = 0; i < count; ++i) {
    plan_.blocks[i] = order_[tree_->order[i]];
    plan_.blockScalar[i] = scalar;
    plan_.patternScalar[i] = pattern_.layout().offset(plan_.blocks[i]);
    scalar += dimensions_[tree_->order[i]];
  }
  plan_.blockScalar[count] = scalar;
}

void FactorPlanBuilder::layOutNodes() {
  scratch_.assign(order_.size(), 0);
  plan_.storage.resize(plan_.nodes.size() + 1);
  listChildren();
  for (int k = 0; k < static_cast<int>(plan_.nodes.size()); ++k) {
    const TreeNode& node = plan_.nodes[k];
    NodeStorage& storage = plan_.storage[k];
    storage.scalar = plan_.blockScalar[node.firstBlock];
    storage.paddedColumns = node.leaf ? 0 : ceil8(node.columns);
    storage.paddedRows = ceil8(node.rows);
    storage.values = plan_.valueCount;
    storage.vector = plan_.workspaceCount;
    storage.updateLayout = updateLayoutOf(node);
    storage.runs = static_cast<std::int64_t>(plan_.runs.size());
    storage.spans = static_cast<std::int64_t>(plan_.spans.size());
    storage.leafColumns = static_cast<std::int64_t>(plan_.leafColumns.size());
    storage.panels = static_cast<std::int64_t>(plan_.panels.size());
    targetBegin_.push_back(static_cast<std::int64_t>(targets_.size()));
    plan_.workspaceCount += storage.paddedColumns + storage.paddedRows;
    addSpans(k);
    if (node.leaf) {
      layOutLeaf(k, storage);
    } else {
      storage.stride = oddStride(storage.paddedColumns + storage.paddedRows);
      plan_.valueCount += narrow(storage.stride * node.columns);
    }
    if (node.parent >= 0) addRuns(k);
  }
  NodeStorage& end = plan_.storage.back();
  end.values = plan_.valueCount;
  end.runs = static_cast<std::int64_t>(plan_.runs.size());
  end.spans = static_cast<std::int64_t>(plan_.spans.size());
  end.leafColumns = static_cast<std::int64_t>(plan_.leafColumns.size());
}

UpdateLayout FactorPlanBuilder::updateLayoutOf(const TreeNode& node) const {
  const auto rows = static_cast<int>(oddStride(node.rows));
  if (!node.leaf) return {rows, updateColumns};
  // A multiple of 8 and of the blocks' dimension.
  const int b = dimension(tree_->order[node.firstBlock]);
  if (b < leastPanelDimension) return {rows, rows};
  return {rows, std::lcm(8, b) > 24 ? std::lcm(8, b) : updateColumns};
}

void FactorPlanBuilder::listChildren() {
  for (const TreeNode& node : plan_.nodes) {
    if (node.parent >= 0) ++plan_.storage[node.parent + 1].children;
  }
  for (std::size_t k = 1; k < plan_.storage.size(); ++k) plan_.storage[k].children += plan_.storage[k - 1].children;
  plan_.children.resize(plan_.storage.back().children);
  std::vector<std::int64_t> next;
  for (const NodeStorage& storage : plan_.storage) next.push_back(storage.children);
  for (int k = 0; k < static_cast<int>(plan_.nodes.size()); ++k) {
    const int parent = plan_.nodes[k].parent;
    if (parent >= 0) plan_.children[next[parent]++] = k;
  }
}

/// Walks the child's rows and the parent's columns and rows side by side; both ascend.
void FactorPlanBuilder::addRuns(int node) {
  const TreeNode& parent = plan_.nodes[plan_.nodes[node].parent];
  const std::span<const int> parentRows = below(parent.lastBlock - 1);
  const int paddedColumns = ceil8(parent.columns);
  std::size_t p = 0;
  int parentScalar = paddedColumns;
  int source = 0;
  const std::size_t first = plan_.runs.size();
  for (const int row : rowsBelow(node)) {
    const int column = tree_->position[row];
    int destination = 0;
    if (column < parent.lastBlock) {
      destination = plan_.blockScalar[column] - plan_.blockScalar[parent.firstBlock];
    } else {
      while (parentRows[p] != row) parentScalar += dimension(parentRows[p++]);
      destination = parentScalar;
    }
    RowRun* last = plan_.runs.size() > first ? &plan_.runs.back() : nullptr;
    // A run ends where the columns end, even if padding happens to be empty there.
    const bool border = destination == paddedColumns;
    if (last != nullptr && last->destination + last->length == destination && !border) {
      last->length += dimension(row);
    } else {
      plan_.runs.push_back({source, dimension(row), destination});
    }
    source += dimension(row);
  }
}

void FactorPlanBuilder::addSpans(int node) {
  const std::size_t first = plan_.spans.size();
  for (const int row : rowsBelow(node)) {
    const int scalar = plan_.blockScalar[tree_->position[row]];
    if (plan_.spans.size() > first && plan_.spans.back().begin + plan_.spans.back().length == scalar) {
      plan_.spans.back().length += dimension(row);
    } else {
      plan_.spans.push_back({scalar, dimension(row)});
    }
  }
}

void FactorPlanBuilder::layOutLeaf(int node, NodeStorage& storage) {
  const TreeNode& leaf = plan_.nodes[node];
  plan_.leafDimension = dimension(tree_->order[leaf.firstBlock]);
  for (const int row : rowsBelow(node)) scratch_[row] = storage.outside++;  // of the block rows outside
  const int blocks = leaf.lastBlock - leaf.firstBlock + storage.outside;
  plan_.workspaceCount += ceil8(blocks * leafPlace(plan_.leafDimension));
  std::int32_t offset = 0;
  for (int column = leaf.firstBlock; column < leaf.lastBlock; ++column) addLeafColumn(node, column, offset);
  storage.panelCount = addLeafPanels(plan_, node);
  plan_.valueCount += ceil8(offset + 8);
}

void FactorPlanBuilder::addLeafColumn(int node, int column, std::int32_t& offset) {
  const int b = plan_.leafDimension;
  const std::span<const int> rows = below(column);
  const TreeNode& leaf = plan_.nodes[node];
  const int columns = leaf.lastBlock - leaf.firstBlock;
  LeafColumn entry{};
  entry.values = offset;
  entry.scalar = (column - leaf.firstBlock) * b;
  entry.below = static_cast<std::int32_t>(rows.size());
  entry.group = static_cast<std::int16_t>(tree_->groups[column]);
  entry.rows = narrow(static_cast<std::int64_t>(plan_.leafRows.size()));
  // Rows ascend, and a leaf's columns come before what is outside.
  const std::size_t first = plan_.leafRows.size();
  plan_.leafRows.resize(first + rows.size());
  plan_.leafPositions.resize(first + rows.size(), 0);
  std::int32_t* const places = plan_.leafRows.data() + first;
  std::int32_t* const positions = plan_.leafPositions.data() + first;
  const int place = leafPlace(b);
  std::size_t i = 0;
  for (; i < rows.size() && tree_->position[rows[i]] < leaf.lastBlock; ++i) {
    const int target = tree_->position[rows[i]] - leaf.firstBlock;
    targets_.push_back(target);
    places[i] = target * place;
  }
  entry.inside = static_cast<std::int32_t>(i);
  for (; i < rows.size(); ++i) {
    places[i] = (columns + scratch_[rows[i]]) * place;
    positions[i] = scratch_[rows[i]] * b;
  }
  entry.destinations = narrow(destinations_);
  destinations_ += std::int64_t{entry.inside} * (2 * std::int64_t{entry.below} - entry.inside + 1) / 2;
  plan_.leafColumns.push_back(entry);
  offset = narrow(std::int64_t{offset} + (entry.below + 1) * b * leafStride(b));
}

void FactorPlanBuilder::listDestinations() {
  constexpr double nanosecondsEach = 1.0;
  plan_.leafDestinations = std::make_unique_for_overwrite<std::int32_t[]>(static_cast<std::size_t>(destinations_));
  plan_.leafDestinationCount = destinations_;
  const auto count = static_cast<std::int64_t>(plan_.nodes.size());
  const int threads = worthwhileThreads(threads_, nanosecondsEach * static_cast<double>(destinations_));
  parallelFor(count, threads, [&](std::int64_t node) {
    if (plan_.nodes[node].leaf) addLeafDestinations(static_cast<int>(node), targets_.data() + targetBegin_[node]);
  });
}

/// For blocks q ≤ i of a column: block (i, q) of the column of q. Columns that are met are taken one by one: where
/// their blocks lie is spread out once, and looked up by all columns that meet them.
void FactorPlanBuilder::addLeafDestinations(int node, const int* target) {
  const TreeNode& leaf = plan_.nodes[node];
  const int rowPlace = leafPlace(plan_.leafDimension);
  const int size = plan_.leafDimension * leafStride(plan_.leafDimension);
  const int count = leaf.lastBlock - leaf.firstBlock;
  const LeafColumn* columns = plan_.leafColumns.data() + plan_.storage[node].leafColumns;
  std::vector<int> begin(count + 1, 0);  // of the list of a target's meetings
  const std::int64_t targets = std::accumulate(columns, columns + count, std::int64_t{0},
                                               [](std::int64_t sum, const LeafColumn& c) { return sum + c.inside; });
  for (std::int64_t k = 0; k < targets; ++k) ++begin[target[k] + 1];
  for (int j = 0; j < count; ++j) begin[j + 1] += begin[j];
  std::vector<std::pair<int, int>> meetings(targets);  // column and number of the block in it
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for (int j = 0; j < count; ++j) {
    for (int q = 0; q < columns[j].inside; ++q) meetings[next[*target++]++] = {j, q};
  }
  std::vector<std::int32_t> place((count + plan_.storage[node].outside) * rowPlace);  // by row, as leafRows has them
  for (int t = 0; t < count; ++t) {
    if (begin[t] == begin[t + 1]) continue;
    std::int32_t offset = columns[t].values;
    place[t * rowPlace] = offset;
    for (int i = 0; i < columns[t].below; ++i) place[plan_.leafRows[columns[t].rows + i]] = offset += size;
    for (int m = begin[t]; m < begin[t + 1]; ++m) {
      const auto [j, q] = meetings[m];
      const LeafColumn& column = columns[j];
      const std::int32_t* rows = plan_.leafRows.data() + column.rows;
      std::int32_t* destination =
          plan_.leafDestinations.get() + column.destinations + q * column.below - q * (q - 1) / 2;
      for (int i = q; i < column.below; ++i) *destination++ = place[rows[i]];
    }
  }
}

void FactorPlanBuilder::listLoads() {
  constexpr double nanosecondsEach = 10.0;
  std::vector<int> place(order_.size());  // of a pattern block in the factor's numbering
  for (std::size_t i = 0; i < place.size(); ++i) place[plan_.blocks[i]] = static_cast<int>(i);
  std::vector<std::int64_t> source(order_.size() + 1, 0);  // of each pattern column's first block
  const BlockLayout& layout = pattern_.layout();
  for (int j = 0; j < pattern_.blocks(); ++j) {
    std::int64_t rows = (pattern_.columnEnd(j) - pattern_.columnBegin(j)) * plan_.uniformDimension;
    for (std::int64_t k = pattern_.columnBegin(j); plan_.uniformDimension == 0 && k < pattern_.columnEnd(j); ++k)
      rows += layout.dimension(pattern_.row(k));
    source[j + 1] = source[j] + rows * layout.dimension(j);
  }
  plan_.loads.resize(pattern_.entries());
  plan_.loadBegin.push_back(0);
  for (const int block : plan_.blocks)
    plan_.loadBegin.push_back(plan_.loadBegin.back() + pattern_.columnEnd(block) - pattern_.columnBegin(block));
  const auto count = static_cast<std::int64_t>(plan_.nodes.size());
  const int threads = worthwhileThreads(threads_, nanosecondsEach * static_cast<double>(pattern_.entries()));
  parallelFor(count, threads, [&](std::int64_t node) { listNodeLoads(static_cast<int>(node), place, source); });
}

void FactorPlanBuilder::listNodeLoads(int k, const std::vector<int>& place, const std::vector<std::int64_t>& source) {
  const BlockLayout& layout = pattern_.layout();
  const TreeNode& node = plan_.nodes[k];
  const NodeStorage& storage = plan_.storage[k];
  const std::span<const int> nodeRows = rowsBelow(k);
  for (int column = node.firstBlock; column < node.lastBlock; ++column) {
    const int block = plan_.blocks[column];
    const int columns = layout.dimension(block);
    const std::span<const int> rows = node.leaf ? below(column) : nodeRows;
    const LeafColumn* leaf = node.leaf ? &plan_.leafColumns[storage.leafColumns + column - node.firstBlock] : nullptr;
    const int firstScalar = plan_.blockScalar[column] - storage.scalar;
    std::int64_t from = source[block];
    std::size_t p = 0;
    int scalar = storage.paddedColumns;
    LoadEntry* load = plan_.loads.data() + plan_.loadBegin[column];
    for (std::int64_t entry = pattern_.columnBegin(block); entry < pattern_.columnEnd(block); ++entry) {
      const int row = place[pattern_.row(entry)];
      const int height = layout.dimension(pattern_.row(entry));
      std::int64_t destination = 0;
      if (leaf != nullptr) {
        const int target = tree_->order[row];
        while (row != column && rows[p] != target) ++p;
        const auto place = static_cast<std::int64_t>(row == column ? 0 : p + 1);  // among the column's blocks
        destination = leaf->values + place * columns * leafStride(columns);
      } else if (row < node.lastBlock) {
        destination = firstScalar * storage.stride + plan_.blockScalar[row] - storage.scalar;
      } else {
        while (rows[p] != tree_->order[row]) scalar += dimension(rows[p++]);
        destination = firstScalar * storage.stride + scalar;
      }
      *load++ = {from, narrow(destination), static_cast<std::int16_t>(height), static_cast<std::int16_t>(columns)};
      from += std::int64_t{height} * columns;
    }
  }
}

void FactorPlanBuilder::placeUpdates() {
  for (int node = 0; node < static_cast<int>(plan_.nodes.size()); ++node) {
    const UpdateLayout layout = plan_.storage[node].updateLayout;
    const int strips = plan_.nodes[node].rows / layout.width;
    const int left = plan_.nodes[node].rows % layout.width;
    plan_.storage[node].updateCount = stripBegin(layout, strips) + left * stripStride(layout, strips);
  }
  const auto sizeOf = [&](int node) {
    const NodeStorage& storage = plan_.storage[node];
    return plan_.nodes[node].rows == 0 ? 0 : storage.updateCount + storage.panelCount + 8;
  };
  const auto place = [&](ArenaPlanner& planner, int node) {
    plan_.storage[node].update = planner.allocate(sizeOf(node));
    plan_.storage[node].sharedUpdate = true;
  };
  const auto releaseChildren = [&](ArenaPlanner& planner, int node) {
    for (const int child : plan_.childrenOf(node)) planner.release(plan_.storage[child].update, sizeOf(child));
  };
  for (const TaskSchedule::Task& task : plan_.schedule.tasks) {
    ArenaPlanner planner;  // of the thread that runs the task; the root's update matrix outlives it
    for (int node = task.begin; node < task.end - 1; ++node) {
      plan_.storage[node].update = planner.allocate(sizeOf(node));
      releaseChildren(planner, node);
    }
    plan_.workerArena = std::max(plan_.workerArena, planner.peak());
  }
  plan_.workers = std::min(plan_.schedule.threads, static_cast<int>(plan_.schedule.tasks.size()));
  ArenaPlanner planner;
  planner.allocate(plan_.workers * plan_.workerArena);
  for (const TaskSchedule::Task& task : plan_.schedule.tasks) place(planner, task.end - 1);
  planner.release(0, plan_.workers * plan_.workerArena);
  for (const int node : plan_.schedule.top) {
    place(planner, node);
    releaseChildren(planner, node);
  }
  plan_.arenaCount = planner.peak();
}

}  // namespace quiver::detail
