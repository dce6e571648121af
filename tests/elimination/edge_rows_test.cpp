#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/problem/problem.h>

#include "projections.h"

namespace quiver::test {
namespace {

/// Numbers of the first `count` edges of a panel.
std::vector<double> numbersOf(const Panel& panel, const EdgeShape& shape, int count) {
  const int lanes = Panel::lanes * ((count + Panel::lanes - 1) / Panel::lanes);
  std::vector<double> numbers(panel.residual, panel.residual + lanes * shape.rows);
  numbers.insert(numbers.end(), panel.squaredError, panel.squaredError + count);
  numbers.insert(numbers.end(), panel.cost, panel.cost + count);
  for (std::size_t role = 0; role < shape.columns.size(); ++role)
    numbers.insert(numbers.end(), panel.jacobian[role],
                   panel.jacobian[role] + lanes * shape.rows * shape.columns[role]);
  return numbers;
}

const EdgeBatch* batchWithRows(const Problem& problem) {
  for (int b = 0; b < problem.batches(); ++b) {
    if (problem.batch(b).rowBytes() > 0) return &problem.batch(b);
  }
  return nullptr;
}

/// Rows and lists of the same edges must give the same bits, in whatever order rows were made.
void expectSameBits(const Problem& problem, const EdgeBatch& batch, const EdgeRows& rows,
                    const std::vector<std::int32_t>& edges) {
  const EdgeShape shape = batch.largestShape();
  PanelBuffer list(shape);
  PanelBuffer row(shape);
  for (std::size_t begin = 0; begin < edges.size(); begin += Panel::capacity) {
    const std::size_t count = std::min<std::size_t>(Panel::capacity, edges.size() - begin);
    const std::span<const std::int32_t> some(edges.data() + begin, count);
    batch.linearize(problem.state(), some, list.panel());
    batch.linearizeRows(problem.state(), rows, static_cast<std::int64_t>(begin) / Panel::lanes, some, row.panel());
    ASSERT_EQ(numbersOf(list.panel(), shape, static_cast<int>(count)),
              numbersOf(row.panel(), shape, static_cast<int>(count)));
    batch.evaluate(problem.state(), some, list.panel());
    batch.evaluateRows(problem.state(), rows, static_cast<std::int64_t>(begin) / Panel::lanes, some, row.panel());
    ASSERT_TRUE(std::equal(list.panel().cost, list.panel().cost + count, row.panel().cost));
  }
}

TEST(EdgeRows, GiveTheBitsThatListsGive) {
  BundleShape shape;
  shape.cameras = 10;
  Graph graph = bundle(shape);
  std::mt19937 random(3);
  graph.forEachEdge([&](Edge& edge) {
    if (random() % 3 == 0) edge.setRobustKernel(RobustKernelHuber(0.5));
  });
  Problem problem(graph, {.level = 0, .free = {}, .threads = 1});
  const EdgeBatch* batch = batchWithRows(problem);
  if (batch == nullptr) GTEST_SKIP() << "this processor runs one edge at a time";
  std::vector<std::int32_t> edges(static_cast<std::size_t>(batch->size()) / Panel::lanes * Panel::lanes);
  std::iota(edges.begin(), edges.end(), 0);
  std::shuffle(edges.begin(), edges.end(), random);
  std::fill_n(edges.begin(), 3, edges.front());  // an edge may be named more than once
  EdgeRows rows;
  batch->packRows(edges, rows, 2);
  EXPECT_EQ(rows.bytes(), batch->rowBytes() * static_cast<std::int64_t>(edges.size()) / Panel::lanes);
  expectSameBits(problem, *batch, rows, edges);

  const std::int64_t revision = batch->revision();
  problem.refresh();
  EXPECT_EQ(batch->revision(), revision) << "nothing has changed";
  const_cast<Edge&>(batch->edge(0)).setRobustKernel(RobustKernelHuber(0.7));
  problem.refresh();
  EXPECT_GT(batch->revision(), revision);
  EXPECT_EQ(rows.revision, revision);
}

TEST(EdgeRows, FollowChangedMeasurements) {
  Graph graph = bundle({});
  const auto disturb = [](Graph& target, double width) {
    target.forEachEdge([&](Edge& edge) { edge.setRobustKernel(RobustKernelHuber(width)); });
  };
  disturb(graph, 1.0);
  Optimizer optimizer({.maxIterations = 3, .algorithm = "lm", .threads = 1});
  const Summary first = optimizer.optimize(graph);
  Graph changed = graph;
  disturb(graph, 1e-3);
  disturb(changed, 1e-3);
  const Summary again = optimizer.optimize(graph);
  EXPECT_TRUE(optimizer.reused());
  const Summary anew = optimize(changed, {.maxIterations = 3, .algorithm = "lm", .threads = 1});
  EXPECT_EQ(again.initialCost, anew.initialCost);
  EXPECT_EQ(again.finalCost, anew.finalCost);
  EXPECT_NE(again.initialCost, first.finalCost);
}

}  // namespace
}  // namespace quiver::test
