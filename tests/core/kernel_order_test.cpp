// Edges that differ in the shape of their kernel alone have a canonical order too.
#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

TEST(KernelOrder, ShapesCount) {
  std::vector<double> shapes = {-2.0, -1.0, 0.0, 0.3, 1.0, 1.5, 2.0, 0.7};
  std::mt19937 random(3);
  std::vector<double> costs;
  for (int round = 0; round < 10; ++round) {
    std::shuffle(shapes.begin(), shapes.end(), random);
    Graph graph(makeRegistry());
    graph.addVertex<VertexPoint>(0, Vector<double, 2>(0.1, 0.7));
    for (const double shape : shapes) {
      graph.addEdge<EdgePoint>({0}, Vector<double, 2>(1.0 / 3.0, 5.0), weight2())
          .setRobustKernel(RobustKernel(barronKernel(), 0.3, shape));
    }
    graph.addEdge<EdgePoint>({0}, Vector<double, 2>(0.0, 0.0), weight2());
    for (const IterationReport& report : optimize(graph).iterations) costs.push_back(report.cost);
  }
  ASSERT_EQ(costs.size() % 10, 0U);
  const std::size_t steps = costs.size() / 10;
  ASSERT_GT(steps, 0U);
  for (std::size_t i = steps; i < costs.size(); ++i) EXPECT_EQ(costs[i], costs[i % steps]);
}

TEST(PerfectStart, IsConverged) {
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    for (const double kernel : {0.0, 1.0}) {
      Graph graph = ringGraph<EdgeRangeAnalyticLanes>(20, 4);
      if (kernel > 0.0) graph.forEachEdge([&](Edge& edge) { edge.setRobustKernel(RobustKernelHuber(kernel)); });
      (void)optimize(graph, {.costTolerance = 0.0, .gradientTolerance = 0.0});
      const Summary again = optimize(graph, {.algorithm = algorithm});
      EXPECT_EQ(again.status, Status::converged) << algorithm << ": " << again.reason;
    }
  }
}

}  // namespace
}  // namespace quiver
