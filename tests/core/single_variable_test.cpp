#include <quiver/solvers/single_variable.h>

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/solvers/backends/dense_solver.h>
#include <quiver/solvers/normal_equations.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

/// A free pose (id 0) among fixed poses and points, joined by edges in either role, a share of them with kernels.
Graph poseAmongKnown(int edges, unsigned seed, bool robust) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const SE2<double> truth(0.8, -0.5, 0.7);
  Graph graph(makeRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>(0.3, -0.2, 0.4));
  for (int i = 1; i <= edges; ++i) {
    const SE2<double> known(10.0 * normal(random), 10.0 * normal(random), normal(random));
    if (i % 3 == 0) {
      graph.addVertex<VertexPoint>(i, known.translation()).setFixed(true);
      const double range = (known.translation() - truth.translation()).norm() + 0.1 * normal(random);
      graph.addEdge<EdgeRangeAnalyticLanes>({0, i}, range, weight(4.0));
      continue;
    }
    graph.addVertex<VertexSE2>(i, known).setFixed(true);
    const bool first = i % 2 == 0;
    const SE2<double> motion = first ? truth.between(known) : known.between(truth);
    const Vector<double, 3> noise(0.1 * normal(random), 0.1 * normal(random), 0.1 * normal(random));
    graph.addEdge<EdgeSE2>({first ? 0 : i, first ? i : 0}, motion.retract(noise), weight3());
  }
  int edge = 0;
  graph.forEachEdge([&](Edge& each) {
    if (robust) each.setRobustKernel(edge++ % 4 == 3 ? RobustKernel(RobustKernelCauchy(2.0)) : RobustKernelHuber(1.5));
  });
  return graph;
}

/// One free point in edges of run-time arity.
Graph pointInMeans() {
  Graph graph(makeRegistry());
  for (int i = 0; i < 5; ++i) graph.addVertex<VertexPoint>(i, Vector<double, 2>(i, 2.0 * i)).setFixed(i != 2);
  graph.addEdge<EdgeMean>({2}, Vector<double, 2>(1.0, 2.0), weight2(3.0));
  graph.addEdge<EdgeMean>({0, 2, 4}, Vector<double, 2>(0.5, 2.5), weight2());
  graph.addEdge<EdgeMean>({0, 1}, Vector<double, 2>(0.5, 2.5), weight2());
  graph.addEdge<EdgePoint>({2}, Vector<double, 2>(1.0, 1.0), weight2());
  return graph;
}

std::vector<double> numbersOf(const LinearSystem& system, std::size_t size) {
  std::vector<double> numbers(system.gradient().begin(), system.gradient().end());
  numbers.insert(numbers.end(), system.diagonal().begin(), system.diagonal().end());
  std::vector<double> x(size), y(size);
  for (std::size_t i = 0; i < size; ++i) {
    x.assign(size, 0.0);
    x[i] = 1.0;
    system.multiply(x, y);
    numbers.insert(numbers.end(), y.begin(), y.end());
  }
  return numbers;
}

void expectNear(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-11 * std::max(1.0, std::abs(b[i]))) << i;
}

/// H, g, totals and a damped step against the assembly of all variables.
void expectTwin(Graph graph) {
  Problem problem(graph, {});
  ASSERT_TRUE(SingleVariable::serves(problem));
  const auto size = static_cast<std::size_t>(problem.scalars());
  SingleVariable single;
  NormalEquations twin(makeDenseSolver());
  single.analyze(problem, {}, 1);
  twin.analyze(problem, {}, 1);
  const CostTotals totals = single.linearize(problem.state());
  const CostTotals expected = twin.linearize(problem.state());
  EXPECT_NEAR(totals.chi2, expected.chi2, 1e-12 * expected.chi2);
  EXPECT_NEAR(totals.cost, expected.cost, 1e-12 * expected.cost);
  expectNear(numbersOf(single, size), numbersOf(twin, size));
  const std::vector<double> damping(size, 0.1);
  std::vector<double> step(size), twinStep(size);
  EXPECT_TRUE(single.solve(damping, step, StopCondition()).ok());
  EXPECT_TRUE(twin.solve(damping, twinStep, StopCondition()).ok());
  expectNear(step, twinStep);
  EXPECT_TRUE(single.applyInverse(step));
  EXPECT_TRUE(twin.applyInverse(twinStep));
  expectNear(step, twinStep);
}

TEST(SingleVariable, AgreesWithTheSystemOfAllVariables) {
  for (const int edges : {3, 7, 8, 9, 64, 200, 5000}) {
    for (const bool robust : {false, true}) expectTwin(poseAmongKnown(edges, static_cast<unsigned>(edges), robust));
  }
  expectTwin(pointInMeans());
}

TEST(SingleVariable, TrialsAreTakenOrDropped) {
  for (const bool all : {false, true}) {
    Graph graph = poseAmongKnown(50, 1, true);
    Problem problem(graph, {});
    const auto size = static_cast<std::size_t>(problem.scalars());
    std::unique_ptr<LinearSystem> system = std::make_unique<SingleVariable>();
    if (all) system = std::make_unique<NormalEquations>(makeDenseSolver());
    system->analyze(problem, {}, 1);
    system->linearize(problem.state());
    const std::vector<double> before = numbersOf(*system, size);
    problem.retract(std::vector<double>{0.1, 0.2, -0.1});
    const auto tried = system->tryState(problem.trial());
    ASSERT_TRUE(tried);
    EXPECT_EQ(tried->chi2, problem.evaluate(problem.trial()).chi2);
    system->dropTrial();
    EXPECT_EQ(numbersOf(*system, size), before) << "dropped";
    system->tryState(problem.trial());
    problem.acceptTrial();
    EXPECT_EQ(system->linearize(problem.state()).cost, tried->cost);
    const std::vector<double> taken = numbersOf(*system, size);
    EXPECT_EQ(system->linearize(problem.state()).cost, tried->cost);
    EXPECT_EQ(numbersOf(*system, size), taken) << "the same as without a trial";
    EXPECT_NE(taken, before);
    // What was computed for a trial that was dropped says nothing of the next one, though it lies where that lay.
    problem.retract(std::vector<double>{2.0, 0.2, 0.5});
    system->tryState(problem.trial());
    system->dropTrial();
    EXPECT_EQ(numbersOf(*system, size), taken);
    problem.retract(std::vector<double>{-0.1, 0.1, 0.1});
    problem.acceptTrial();
    system->linearize(problem.state());
    const std::vector<double> next = numbersOf(*system, size);
    system->linearize(problem.state());
    EXPECT_EQ(numbersOf(*system, size), next);
  }
}

TEST(SingleVariable, SameBitsForAnyOrderAndAnyThreads) {
  std::vector<double> reference;
  for (const unsigned seed : {0U, 3U}) {
    for (const int threads : {1, 2}) {
      std::mt19937 random(5);
      std::normal_distribution<double> normal;
      std::vector<Vector<double, 2>> measurements(20000);
      // The first numbers repeat, so that the others decide the order too.
      for (auto& z : measurements) z = Vector<double, 2>(std::round(5.0 * normal(random)), normal(random));
      std::mt19937 shuffle(seed);
      if (seed > 0) std::shuffle(measurements.begin(), measurements.end(), shuffle);
      Graph graph(makeRegistry());
      graph.addVertex<VertexPoint>(0, Vector<double, 2>(3.0, 4.0));
      for (const auto& z : measurements)
        graph.addEdge<EdgePoint>({0}, z, weight2()).setRobustKernel(RobustKernelCauchy(1.0));
      const Summary summary = optimize(graph, {.threads = threads});
      ASSERT_EQ(summary.status, Status::converged) << summary.reason;
      const Vector<double, 2> x = graph.vertex<VertexPoint>(0).estimate();
      const std::vector<double> numbers{summary.finalCost, x[0], x[1]};
      if (reference.empty()) reference = numbers;
      EXPECT_EQ(numbers, reference) << threads << " threads, order " << seed;
    }
  }
}

TEST(SingleVariable, IsChosenAndFindsTheOptimum) {
  for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph graph = poseAmongKnown(60, 2, false);
    Graph twin = graph;
    const Summary summary = optimize(graph, {.algorithm = algorithm});
    const Summary expected = optimize(twin, {.algorithm = algorithm, .linearSolver = "block"});
    EXPECT_THAT(summary.plan.linearSolverReason, ::testing::HasSubstr("one variable of 3 scalars"));
    EXPECT_EQ(summary.status, Status::converged) << summary.reason;
    EXPECT_NEAR(summary.finalChi2, expected.finalChi2, 1e-9 * expected.finalChi2) << algorithm;
  }
}

TEST(SingleVariable, NamesAFreeDirection) {
  // Two ranges to the same place say nothing about the way round it, nor about the heading.
  Graph graph(makeRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>(1.0, 2.0, 0.5));
  graph.addVertex<VertexPoint>(1, Vector<double, 2>(4.0, 6.0)).setFixed(true);
  graph.addEdge<EdgeRangeAnalytic>({0, 1}, 4.0, weight(1.0));
  const Summary summary = optimize(graph, {.algorithm = "gn", .gauge = GaugePolicy::free});
  EXPECT_EQ(summary.status, Status::numericalFailure);
  EXPECT_THAT(summary.reason, ::testing::AllOf(::testing::HasSubstr("vertex 0"), ::testing::HasSubstr("VERTEX_SE2")));
}

}  // namespace
}  // namespace quiver
