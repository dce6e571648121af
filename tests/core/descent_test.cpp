#include <quiver/core/algorithm/descent.h>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>

#include "dense_twin.h"

namespace quiver {
namespace {

using namespace test;

/// The twin's differences err by 1e-9 of the step; chi2 after a step that far from the optimum moves by as much.
constexpr double traceTolerance = 1e-6;

TEST(Descent, FollowsADenseTwin) {
  Graph graph = ringGraph<EdgeRangeAnalytic>(15, 4);
  graph.vertex<VertexSE2>(0).setFixed(true);
  DenseTwin twin(graph, 15, 4);
  const Summary summary = optimize(graph, {.maxIterations = 4, .algorithm = "gn"});
  EXPECT_NEAR(summary.initialChi2, twin.chi2(), 1e-10 * summary.initialChi2);
  ASSERT_EQ(summary.iterations.size(), 4U);
  for (const IterationReport& report : summary.iterations)
    EXPECT_NEAR(report.chi2, twin.step(0.0), traceTolerance * report.chi2) << report.iteration;
}

TEST(Descent, ADampedStepIsTheDenseTwins) {
  for (const double damping : {1e-4, 0.1, 3.0}) {
    Graph graph = ringGraph<EdgeRangeAnalytic>(15, 4);
    graph.vertex<VertexSE2>(0).setFixed(true);
    DenseTwin twin(graph, 15, 4);
    const Summary summary = optimize(graph, {.maxIterations = 1, .algorithm = "lm", .initialDamping = damping});
    ASSERT_TRUE(summary.iterations.at(0).accepted);
    EXPECT_NEAR(summary.finalChi2, twin.step(damping), traceTolerance * summary.finalChi2) << damping;
  }
}

TEST(Descent, AllSolversAndAlgorithmsMeetAtOneOptimum) {
  Graph reference = ringGraph<EdgeRangeDual>(30, 6);
  const double best = optimize(reference).finalChi2;
  for (const char* solver : {"auto", "block", "dense", "eigen", "pcg"}) {
    for (const char* algorithm : {"gn", "lm", "dogleg"}) {
      Graph graph = ringGraph<EdgeRangeDual>(30, 6);
      const Summary summary = optimize(graph, {.algorithm = algorithm, .linearSolver = solver});
      EXPECT_EQ(summary.status, Status::converged) << summary.reason;
      EXPECT_NEAR(summary.finalChi2, best, 1e-8 * best) << solver << " " << algorithm;
    }
  }
}

TEST(Descent, NeverEndsAboveTheLowestCostMet) {
  Graph graph = ringGraph<EdgeRangeDual>(30, 6);
  for (int id = 0; id < 30; id += 2) graph.vertex<VertexSE2>(id).setEstimate(SE2<double>(-20.0 * id, 3.0, 2.5));
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    for (const int limit : {1, 2, 3, 5, 20}) {
      Graph copy(graph);
      const Summary summary = optimize(copy, {.maxIterations = limit, .algorithm = algorithm});
      double lowest = summary.initialCost;
      for (const IterationReport& report : summary.iterations) lowest = std::min(lowest, report.cost);
      EXPECT_LE(summary.finalCost, lowest * (1.0 + 1e-12)) << algorithm << " " << limit;
    }
  }
}

}  // namespace
}  // namespace quiver
