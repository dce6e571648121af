#include <quiver/core/problem/problem.h>

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/util/error.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

/// Whitened residuals and Jacobians of the first batch whose type is not EDGE_SE2, edge after edge.
std::vector<double> rangeLinearisation(Graph graph) {
  const Problem problem(graph, {});
  std::vector<double> numbers;
  for (int b = 0; b < problem.batches(); ++b) {
    if (problem.edgeType(b).tag() == "EDGE_SE2") continue;
    const EdgeBatch& batch = problem.batch(b);
    PanelBuffer buffer(batch.largestShape());
    for (int i = 0; i < batch.size(); ++i) {
      const std::int32_t edge = i;
      const Panel& panel = buffer.panel();
      batch.linearize(problem.state(), {&edge, 1}, panel);
      numbers.push_back(panel.residual[0]);
      for (int c = 0; c < 3; ++c) numbers.push_back(panel.jacobian[0][c * Panel::lanes]);
      for (int c = 0; c < 2; ++c) numbers.push_back(panel.jacobian[1][c * Panel::lanes]);
    }
  }
  return numbers;
}

void expectNear(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_NEAR(a[i], b[i], tolerance * std::max(1.0, std::abs(b[i]))) << "number " << i;
}

/// Central differences of numbers of size 10 err by about ε^⅔; the weight's root, 20, multiplies that.
constexpr double differenceTolerance = 1e-8;
/// Sums of a few products in another order.
constexpr double roundingTolerance = 1e-13;

TEST(Problem, AllFormsOfAJacobianAgree) {
  const auto analytic = rangeLinearisation(ringGraph<EdgeRangeAnalytic>(12, 3));
  EXPECT_EQ(analytic.size(), 12U * 6U);
  expectNear(rangeLinearisation(ringGraph<EdgeRangeDual>(12, 3)), analytic, roundingTolerance);
  expectNear(rangeLinearisation(ringGraph<EdgeRangeDualLanes>(12, 3)), analytic, roundingTolerance);
  expectNear(rangeLinearisation(ringGraph<EdgeRangeAnalyticLanes>(12, 3)), analytic, roundingTolerance);
  expectNear(rangeLinearisation(ringGraph<EdgeRangeNumeric>(12, 3)), analytic, differenceTolerance);
}

TEST(Problem, AnEdgesNumbersDoNotDependOnItsPlaceInAList) {
  Graph graph = ringGraph<EdgeRangeDualLanes>(40, 0);
  const Problem problem(graph, {});
  const EdgeBatch& batch = problem.batch(0);
  PanelBuffer alone(batch.largestShape());
  PanelBuffer together(batch.largestShape());
  std::vector<std::int32_t> list(61);
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = static_cast<std::int32_t>(i * 17 % list.size());
  batch.linearize(problem.state(), list, together.panel());
  for (std::size_t i = 0; i < list.size(); ++i) {
    batch.linearize(problem.state(), {&list[i], 1}, alone.panel());
    const std::size_t group = i / Panel::lanes;
    const std::size_t lane = i % Panel::lanes;
    for (std::size_t k = 0; k < 9; ++k) {
      ASSERT_EQ(together.panel().jacobian[0][(group * 9 + k) * Panel::lanes + lane],
                alone.panel().jacobian[0][k * Panel::lanes]);
    }
    ASSERT_EQ(together.panel().squaredError[i], alone.panel().squaredError[0]);
  }
}

TEST(Problem, NumbersVariablesInCanonicalOrder) {
  Graph graph = ringGraph<EdgeRangeDual>(6, 2, 5);
  graph.vertex<VertexSE2>(3).setFixed(true);
  graph.vertex<VertexSE2>(4).setFixedDirections(0b111);
  const Problem problem(graph, {});
  EXPECT_EQ(problem.slots(), 8);
  EXPECT_EQ(problem.variables(), 6) << "a mask of all directions is as good as setFixed";
  std::int64_t last = -1;
  for (int variable = 2; variable < problem.variables(); ++variable) {
    const std::int64_t id = problem.vertex(problem.slotOfVariable(variable)).id();
    EXPECT_GT(id, last);
    last = id;
  }
  EXPECT_EQ(problem.vertex(problem.slotOfVariable(0)).id(), 1000) << "VERTEX_POINT comes before VERTEX_SE2";
}

TEST(Problem, SameBitsForAnyOrderOfInsertionAndAnyNumberOfThreads) {
  std::vector<double> reference;
  for (const unsigned seed : {0U, 1U, 2U}) {
    for (const int threads : {1, 2, 3}) {
      Graph graph = ringGraph<EdgeRangeDualLanes>(80, 10, seed);
      const Summary summary = optimize(graph, {.linearSolver = "block", .threads = threads});
      ASSERT_EQ(summary.status, Status::converged) << summary.reason;
      std::vector<double> values = estimates(graph, 80, 10);
      values.push_back(summary.finalChi2);
      if (reference.empty()) reference = values;
      ASSERT_EQ(values, reference) << "seed " << seed << ", " << threads << " threads";
    }
  }
}

TEST(Problem, WantsEstimates) {
  Graph graph = ringGraph<EdgeRangeDual>(7, 0);
  graph.vertex<VertexSE2>(2).setHasEstimate(false);
  EXPECT_THROW(Problem(graph, {}), GraphError);
}

TEST(Problem, KeepsTheEstimateThroughRejectedTrials) {
  Graph graph = ringGraph<EdgeRangeDual>(10, 2);
  Problem problem(graph, {});
  const double before = problem.evaluate(problem.state()).chi2;
  const std::vector<double> delta(static_cast<std::size_t>(problem.scalars()), 0.1);
  problem.retract(delta);
  EXPECT_NE(problem.evaluate(problem.trial()).chi2, before);
  EXPECT_EQ(problem.evaluate(problem.state()).chi2, before);
  problem.saveBest();
  problem.acceptTrial();
  problem.restoreBest();
  EXPECT_EQ(problem.evaluate(problem.state()).chi2, before);
}

}  // namespace
}  // namespace quiver
