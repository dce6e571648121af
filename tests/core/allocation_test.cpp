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

}  // namespace
}  // namespace quiver
