// The same problem in other units: damping may not tell them apart.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/damping_scale.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/quiver.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/vertex_se2.h>

#include "core_types.h"

namespace quiver {
namespace {

using test::EdgePoint;
using test::VertexPoint;

/// e = (10 (y − x²), 1 − x), Rosenbrock's valley.
class EdgeValley : public BaseEdge<EdgeValley, 2, double, VertexPoint> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const S& one, const Vector<S, 2>& x) {
    return Vector<S, 2>(S(10.0) * (x[1] - x[0] * x[0]), one - x[0]);
  }
};

TEST(Units, TheWeightOfAllErrorsIsNone) {
  auto registry = test::makeRegistry();
  registry->addEdge<EdgeValley>("EDGE_VALLEY");
  for (const char* algorithm : {"lm", "dogleg"}) {
    std::size_t steps = 0;
    for (const double weight : {1.0, 1e-8, 1e-12, 1e-24, 1e12}) {
      Graph graph(registry);
      graph.addVertex<VertexPoint>(0, Vector<double, 2>(-1.2, 1.0));
      graph.addEdge<EdgeValley>({0}, 1.0, Matrix<double, 2, 2>(weight * Matrix<double, 2, 2>::Identity()));
      // Costs next to nothing are no errors: that rule is not the one on trial.
      const Summary summary =
          optimize(graph, {.maxIterations = 300, .algorithm = algorithm, .costTolerance = 0.0, .stepTolerance = 1e-14});
      EXPECT_LT((graph.vertex<VertexPoint>(0).estimate() - Vector<double, 2>(1.0, 1.0)).norm(), 1e-6)
          << algorithm << " " << weight << ": " << summary.reason;
      if (steps == 0) steps = summary.iterations.size();
      EXPECT_LE(summary.iterations.size(), steps + 5) << algorithm << " " << weight;
    }
  }
}

/// Poses in a chain with loops, its lengths in units of so many to the metre.
Graph walk(double unit) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Graph graph(builtinRegistry());
  constexpr int count = 60;
  for (int i = 0; i < count; ++i) {
    const double x = (i + 0.5 * normal(random)) * unit;
    const double y = 0.5 * normal(random) * unit;
    graph.addVertex<VertexSE2>(i, SE2<double>(x, y, 0.3 * normal(random)));
  }
  const Matrix<double, 3, 3> information =
      Vector<double, 3>(100.0 / unit / unit, 100.0 / unit / unit, 400.0).asDiagonal();
  for (int i = 0; i < count; ++i) {
    for (const int j : {i + 1, i + 7}) {
      if (j >= count) continue;
      const double x = (j - i + 0.1 * normal(random)) * unit;
      const double y = 0.1 * normal(random) * unit;
      graph.addEdge<EdgeSE2>({i, j}, SE2<double>(x, y, 0.05 * normal(random)), information);
    }
  }
  return graph;
}

TEST(Units, TheUnitOfLengthIsNone) {
  for (const char* algorithm : {"auto", "lm", "dogleg"}) {
    Graph metres = walk(1.0);
    const double cost = optimize(metres, {.maxIterations = 300, .algorithm = algorithm}).finalCost;
    for (const double unit : {1e3, 1e6, 1e9, 1e12, 1e-3, 1e-6}) {
      Graph graph = walk(unit);
      const Summary summary = optimize(graph, {.maxIterations = 300, .algorithm = algorithm});
      EXPECT_EQ(summary.status, Status::converged) << algorithm << " " << unit << ": " << summary.reason;
      EXPECT_NEAR(summary.finalCost, cost, 1e-7 * cost) << algorithm << " " << unit << ": " << summary.reason;
    }
  }
}

TEST(Units, TheGaugeIsHeldInAnyOfThem) {
  Graph metres = walk(1.0);
  const Summary first = optimize(metres, {.algorithm = "gn"});
  for (const double unit : {1e9, 1e-5, 1e-7, 1e-9, 1e-12}) {
    Graph graph = walk(unit);
    const Summary summary = optimize(graph, {.algorithm = "gn"});
    EXPECT_EQ(summary.gauge.reason, first.gauge.reason) << unit;
    EXPECT_EQ(summary.status, Status::converged) << unit << ": " << summary.reason;
    EXPECT_NEAR(summary.finalCost, first.finalCost, 1e-7 * first.finalCost) << unit;
  }
}

/// D against its definition, number by number: pieces, types and dimensions in any mixture.
TEST(Units, DampingIsBoundedByTheLargestOfItsKind) {
  Graph graph(test::makeRegistry());
  std::mt19937 random(3);
  for (int i = 0; i < 3000; ++i) graph.addVertex<VertexSE2>(i, SE2<double>());
  for (int i = 0; i + 1 < 3000; ++i)
    graph.addEdge<EdgeSE2>({i, i + 1}, SE2<double>(), Matrix<double, 3, 3>::Identity());
  for (int i = 0; i < 1001; ++i) {
    graph.addVertex<VertexPoint>(5000 + i, Vector<double, 2>(0.0, 0.0));
    graph.addEdge<EdgePoint>({5000 + i}, Vector<double, 2>(0.0, 0.0), test::weight2());
  }
  const Problem problem(graph, {});
  std::vector<double> diagonal(static_cast<std::size_t>(problem.scalars()));
  for (double& d : diagonal) d = std::pow(10.0, std::uniform_real_distribution<double>(-30.0, 3.0)(random));
  for (int v = 0; v < problem.variables(); ++v) {
    if (problem.dimension(v) == 2) diagonal[static_cast<std::size_t>(problem.offset(v))] = 0.0;
  }
  double largest[2][3] = {};
  for (int v = 0; v < problem.variables(); ++v) {
    for (int i = 0; i < problem.dimension(v); ++i) {
      double& most = largest[problem.dimension(v) - 2][i];
      most = std::max(most, diagonal[static_cast<std::size_t>(problem.offset(v) + i)]);
    }
  }
  const double ofAll[2] = {std::max(largest[0][0], largest[0][1]),
                           std::max({largest[1][0], largest[1][1], largest[1][2]})};
  DampingScale scale(problem);
  scale.update(diagonal);
  for (const int threads : {1, 3}) {
    std::vector<double> damping(diagonal.size(), -1.0);
    scale.scale(0.5, threads, damping);
    for (int v = 0; v < problem.variables(); ++v) {
      for (int i = 0; i < problem.dimension(v); ++i) {
        const auto at = static_cast<std::size_t>(problem.offset(v) + i);
        const double most = largest[problem.dimension(v) - 2][i];
        // What nothing measures is as stiff as what is measured best.
        const double least = most > 0.0 ? 1e-14 * most : ofAll[problem.dimension(v) - 2];
        EXPECT_EQ(damping[at], 0.5 * std::max(diagonal[at], least)) << v << " " << i;
      }
    }
  }
  // Entries that shrink are remembered until a descent begins: all after a step that brings little, else half.
  std::vector<double> before(diagonal.size()), after(diagonal.size()), forgotten(diagonal.size());
  scale.scale(1.0, 1, before);
  const std::vector<double> nothing(diagonal.size(), 1e-40);
  scale.update(nothing, 0.1);
  scale.scale(1.0, 1, after);
  EXPECT_EQ(after, before);
  scale.update(nothing, 0.9);
  scale.scale(2.0, 1, after);
  EXPECT_EQ(after, before);
  scale.restart();
  scale.update(nothing);
  scale.scale(1.0, 1, forgotten);
  EXPECT_EQ(forgotten, nothing);
}

}  // namespace
}  // namespace quiver
