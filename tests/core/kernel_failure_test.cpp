// Robust kernels of the user's whose numbers are not finite.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>

#include "core_types.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;

constexpr double notANumber = std::numeric_limits<double>::quiet_NaN();
const RobustKernelType nanCost{"NanCost", [](double, double, double) { return RobustValue{notANumber, 1.0, 0.0}; }, ""};
const RobustKernelType nanWeight{"NanWeight",
                                 [](double e, double, double) {
                                   return RobustValue{e, notANumber, 0.0};
                                 },
                                 ""};
/// Breaks where errors are small: at the trial, not at the start.
const RobustKernelType nanNear{"NanNear",
                               [](double e, double, double) {
                                 return RobustValue{e < 0.5 ? notANumber : e, 1.0, 0.0};
                               },
                               ""};

Summary solve(const RobustKernelType& kernel, const std::string& algorithm, Graph& graph) {
  for (int i = 0; i < 20; ++i) {
    graph.addVertex<VertexPoint>(i, Vector<double, 2>(2.0, 2.0));
    graph.addEdge<EdgePoint>({i}, Vector<double, 2>(1.0, 1.0), weight2())
        .setRobustKernel(i == 13 ? RobustKernel(kernel, 1.0) : RobustKernel());
  }
  Options options;
  options.algorithm = algorithm;
  return optimize(graph, options);
}

/// A cost below zero would pass for one of zero.
TEST(KernelFailure, ANegativeCostIsNoOptimum) {
  const RobustKernelType negative{"Negative",
                                  [](double e, double, double) {
                                    return RobustValue{-100.0 * e, -100.0, 0.0};
                                  },
                                  ""};
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph graph(makeRegistry());
    const Summary summary = solve(negative, algorithm, graph);
    EXPECT_EQ(summary.status, Status::numericalFailure) << algorithm;
    EXPECT_THAT(summary.reason, HasSubstr("a robust kernel must not be negative")) << algorithm;
  }
}

TEST(KernelFailure, IsNamedAtTheStart) {
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph first(makeRegistry()), second(makeRegistry());
    const Summary cost = solve(nanCost, algorithm, first);
    EXPECT_EQ(cost.status, Status::numericalFailure) << algorithm;
    EXPECT_THAT(cost.reason, HasSubstr("robust kernel NanCost makes the error of edge EDGE_POINT 13 a cost"));
    const Summary weight = solve(nanWeight, algorithm, second);
    EXPECT_EQ(weight.status, Status::numericalFailure) << algorithm;
    EXPECT_THAT(weight.reason, HasSubstr("robust kernel NanWeight gives edge EDGE_POINT 13 a weight"));
  }
}

TEST(KernelFailure, AtATrialIsNoStep) {
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph graph(makeRegistry());
    const Summary summary = solve(nanNear, algorithm, graph);
    EXPECT_TRUE(std::isfinite(summary.finalCost)) << algorithm;
    EXPECT_LE(summary.finalCost, summary.initialCost) << algorithm;
    graph.forEachVertex(
        [](const Vertex& vertex) { EXPECT_TRUE(static_cast<const VertexPoint&>(vertex).estimate().allFinite()); });
  }
}

}  // namespace
}  // namespace quiver
