// A second solve of the same structure allocates nothing, whatever the algorithm, with a gauge held or free.
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/estimates.h>
#include <quiver/core/graph/robust_kernels.h>

#include <tests/allocation_counter.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

void expectNoAllocation(const Graph& start, const std::string& algorithm, GaugePolicy gauge) {
  Graph graph = start;
  Optimizer optimizer({.algorithm = algorithm, .gauge = gauge, .threads = 1});
  for (int call = 0; call < 3; ++call) {
    copyEstimates(start, graph);
    allocations = 0;
    countAllocations = call == 2;
    const Summary& summary = optimizer.optimize(graph);
    countAllocations = false;
    EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  }
  EXPECT_TRUE(optimizer.reused());
  EXPECT_EQ(allocations, 0) << algorithm;
}

TEST(Allocation, ASecondSolveNeedsNone) {
  for (const std::string algorithm : {"auto", "gn", "lm", "dogleg"}) {
    for (const GaugePolicy gauge : {GaugePolicy::automatic, GaugePolicy::fix})
      expectNoAllocation(ringGraph<EdgeRangeAnalyticLanes>(40, 9), algorithm, gauge);
  }
}

TEST(Allocation, NorWithKernelsOrOneVariable) {
  Graph robust = ringGraph<EdgeRangeDual>(40, 9);
  robust.forEachEdge([](Edge& edge) { edge.setRobustKernel(RobustKernelHuber(1.0)); });
  expectNoAllocation(robust, "auto", GaugePolicy::automatic);
  Graph single = ringGraph<EdgeRangeDual>(10, 3);
  single.forEachVertex([](Vertex& vertex) { vertex.setFixed(vertex.id() != 4); });
  expectNoAllocation(single, "auto", GaugePolicy::automatic);
}

/// Allocations of building a pose that positions and poses tell of, and of optimising it.
int allocationsOfOnePose(int edges) {
  const auto registry = makeRegistry();
  allocations = 0;
  countAllocations = true;
  Graph graph(registry);
  graph.addVertex<VertexSE2>(0, SE2<double>(0.1, 0.0, 0.0));
  graph.addVertex<VertexPoint>(1, Vector<double, 2>(5.0, 2.0)).setFixed(true);
  for (int i = 0; i < edges; ++i) graph.addEdge<EdgeRangeAnalyticLanes>({0, 1}, 5.0 + 0.001 * i, weight(1.0));
  (void)optimize(graph, {.maxIterations = 5, .algorithm = "lm", .threads = 1});
  countAllocations = false;
  return allocations;
}

TEST(Allocation, BuildingAndSolvingAllocatesByNoEdge) {
  // Lists that grow by doubling, chunks of 256 edges, but nothing for each edge.
  EXPECT_LE(allocationsOfOnePose(1200), allocationsOfOnePose(300) + 30);
}

}  // namespace
}  // namespace quiver
