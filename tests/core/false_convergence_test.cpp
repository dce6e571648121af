// Descents that must not end too early, where something was huge at the start, and must end where nothing is left.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/quiver.h>
#include <quiver/types_slam2d/edge_se2_prior.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::vector<std::string> algorithms{"gn", "lm", "dogleg", "auto"};

/// Where a point is from a pose, inverted at the unit circle: boundless Jacobians for a point close by, as a pixel has
/// before a camera.
class EdgeInversion : public BaseEdge<EdgeInversion, 2, Vector<double, 2>, VertexSE2, VertexPoint> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& robot, const Vector<S, 2>& point) {
    const Vector<S, 2> p = point - robot.translation();
    return Vector<S, 2>(p / p.squaredNorm() - z);
  }
};

/// Pose 0 fixed, pose 1 beside it by odometry, a point seen from both; the truth is exact. The point's first estimate
/// is at that distance from pose 1.
Graph closePoint(double distance) {
  auto registry = makeRegistry();
  registry->addEdge<EdgeInversion>("EDGE_INVERSION");
  Graph graph(registry);
  graph.addVertex<VertexSE2>(0, SE2<double>()).setFixed(true);
  graph.addVertex<VertexSE2>(1, SE2<double>(0.7, 0.1, 0.05));
  graph.addVertex<VertexPoint>(2, Vector<double, 2>(0.7, 0.1 + distance));
  graph.addEdge<EdgeSE2>({0, 1}, SE2<double>(1.0, 0.0, 0.0), weight3());
  graph.addEdge<EdgeInversion>({1, 2}, Vector<double, 2>(0.0, 0.5), weight2());
  graph.addEdge<EdgeInversion>({0, 2}, Vector<double, 2>(0.2, 0.4), weight2());
  return graph;
}

TEST(FalseConvergence, WhatAHugeJacobianHidIsNoGauge) {
  for (const std::string algorithm : {"gn", "dogleg"}) {
    Graph graph = closePoint(1e-5);
    const Summary summary = optimize(graph, {.maxIterations = 300, .algorithm = algorithm, .gauge = GaugePolicy::fix});
    EXPECT_EQ(summary.status, Status::converged) << algorithm << ": " << summary.reason;
    EXPECT_THAT(summary.gauge.reason, HasSubstr("released")) << algorithm;  // else the case shows nothing
    EXPECT_LT(summary.finalChi2, 1e-15) << algorithm;
    EXPECT_LT((graph.vertex<VertexSE2>(1).estimate().translation() - Vector<double, 2>(1.0, 0.0)).norm(), 1e-6);
    EXPECT_NEAR(summary.initialChi2, std::pow(1e5 - 0.5, 2), 1e-3 * 1e10);
    for (std::size_t i = 0; i < summary.iterations.size(); ++i)
      EXPECT_EQ(summary.iterations[i].iteration, static_cast<int>(i));
  }
}

TEST(FalseConvergence, ATrueGaugeStaysHeld) {
  Graph graph = ringGraph<EdgeRangeDual>(12, 6);
  const Summary summary = optimize(graph, {.algorithm = "gn"});
  EXPECT_EQ(summary.status, Status::converged);
  EXPECT_THAT(summary.gauge.reason, Not(HasSubstr("released")));
  EXPECT_EQ(summary.gauge.fixed.size(), 1U);
}

TEST(FalseConvergence, ATrueGaugeStaysHeldWhereADescentEndsEarly) {
  for (const std::string algorithm : {"gn", "lm", "dogleg"}) {
    for (const double tolerance : {1e-3, 1e-6}) {
      Graph graph = ringGraph<EdgeRangeDual>(40, 6);
      const Summary summary =
          optimize(graph, {.algorithm = algorithm, .gauge = GaugePolicy::fix, .costTolerance = tolerance});
      EXPECT_EQ(summary.status, Status::converged) << algorithm << ": " << summary.reason;
      EXPECT_THAT(summary.gauge.reason, Not(HasSubstr("released"))) << algorithm << ", " << tolerance;
      EXPECT_EQ(summary.gauge.fixed.size(), 1U);
    }
  }
}

TEST(FalseConvergence, NumbersOfAVertexCountByThemselves) {
  // An epoch of 1.7e9 s beside a drift of 1e-7: what rounds the one says nothing of the other.
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.7e9, 0.0));
  graph.addEdge<EdgePoint>({0}, Vector<double, 2>(1.7e9, 1e-4), weight2());
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::converged);
  EXPECT_NEAR(graph.vertex<VertexPoint>(0).estimate()[1], 1e-4, 1e-12);
}

/// A descent that says it has converged finds nothing more when it is asked again.
void expectNothingLeft(Graph& graph, const std::string& algorithm, double tolerance) {
  const Summary first = optimize(graph, {.maxIterations = 500, .algorithm = algorithm});
  ASSERT_EQ(first.status, Status::converged) << algorithm << ": " << first.reason;
  const Summary second = optimize(graph, {.maxIterations = 500, .algorithm = algorithm});
  EXPECT_NEAR(second.finalCost, first.finalCost, tolerance * first.finalCost) << algorithm << ": " << first.reason;
}

TEST(FalseConvergence, AHugeFirstErrorMovesNoGoal) {
  for (const std::string& algorithm : algorithms) {
    Graph stiff = ringGraph<EdgeRangeDual>(30, 12);
    // Two places that the start contradicts, a billion times better known than the rest.
    for (const std::int64_t point : {1002, 1007}) {
      const Vector<double, 2> place = stiff.vertex<VertexPoint>(point).estimate() + Vector<double, 2>(0.8, -0.3);
      stiff.addEdge<EdgePoint>({point}, place, weight2(1e13));
    }
    expectNothingLeft(stiff, algorithm, 1e-9);
  }
}

TEST(FalseConvergence, ErrorsThatCanAllBeZeroEndAtOnce) {
  for (const std::string& algorithm : algorithms) {
    for (const double off : {0.0, 1e-3}) {
      for (const int poses : {3, 30, 3000}) {
        Graph graph(makeRegistry());
        SE2<double> x, step;
        for (int i = 0; i < poses; ++i) {
          graph.addVertex<VertexSE2>(i, x.retract(Vector<double, 3>(off * std::sin(i), off, off * std::cos(i))));
          if (i > 0) graph.addEdge<EdgeSE2>({i - 1, i}, step, weight3(500.0));
          step = SE2<double>(1.0 + 0.01 * (i % 7), 0.3 * std::sin(i), 0.7 * std::cos(3.0 * i));
          x = x * step;
        }
        const Summary summary = optimize(graph, {.algorithm = algorithm});
        EXPECT_EQ(summary.status, Status::converged) << algorithm << ", " << poses << ": " << summary.reason;
        EXPECT_LE(summary.iterations.size(), off == 0.0 ? 0U : 25U) << algorithm << ", " << poses;
        EXPECT_THAT(summary.gauge.reason, Not(HasSubstr("released")));
      }
    }
  }
}

TEST(FalseConvergence, ADampedStepThatIsShortIsNoEnd) {
  // Damping scaled by 1e12 keeps the common motion of three stiff poses short.
  Graph graph(makeRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>()).setFixed(true);
  graph.addVertex<VertexSE2>(1, SE2<double>(1.001, 0.0, 1e-3));
  graph.addVertex<VertexSE2>(2, SE2<double>(2.001, 0.001, 1e-3));
  graph.addEdge<EdgeSE2>({0, 1}, SE2<double>(1.0, 0.0, 0.0), weight3());
  graph.addEdge<EdgeSE2>({1, 2}, SE2<double>(1.0, 0.0, 0.0), weight3(1e12));
  const Summary summary = optimize(graph, {.maxIterations = 200, .algorithm = "lm"});
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_LT(summary.finalChi2, 1e-12);
}

/// A ring with wrong loops about a place far away, under a kernel whose weights settle slowly.
Graph wrongLoopsAt(double distance) {
  const Graph near = ringGraph<EdgeRangeDual>(120, 0);
  Graph graph(makeRegistry());
  const SE2<double> shift(distance, -2.0 * distance, 0.0);
  near.forEachVertex([&](const Vertex& vertex) {
    graph.addVertex<VertexSE2>(vertex.id(), shift * static_cast<const VertexSE2&>(vertex).estimate());
  });
  int at = 0;
  near.forEachEdge([&](const Edge& edge) {
    const auto& odometry = static_cast<const EdgeSE2&>(edge);
    const Vector<double, 3> off(0.3 * std::sin(at), 0.3 * std::cos(3.0 * at), 0.05 * std::sin(5.0 * at));
    const SE2<double> measured = odometry.measurement().retract(at % 2 == 0 ? off : Vector<double, 3>(0.0, 0.0, 0.0));
    graph.addEdge<EdgeSE2>({odometry.vertexId(0), odometry.vertexId(1)}, measured, odometry.information())
        .setRobustKernel(RobustKernel(cauchyKernel(), 0.2));
    ++at;
  });
  return graph;
}

TEST(FalseConvergence, AShortStepFarAwayIsNoEndWhileTheCostFalls) {
  for (const std::string algorithm : {"gn", "dogleg"}) {
    const Options options{.maxIterations = 2000, .algorithm = algorithm, .gauge = GaugePolicy::fix};
    Graph near = wrongLoopsAt(0.0);
    const Summary expected = optimize(near, options);
    EXPECT_EQ(expected.status, Status::converged);
    for (const double distance : {5e5, 5e8}) {
      Graph far = wrongLoopsAt(distance);
      const Summary summary = optimize(far, options);
      EXPECT_EQ(summary.status, Status::converged) << algorithm << ' ' << distance;
      EXPECT_NEAR(summary.finalCost, expected.finalCost, 1e-7 * expected.finalCost) << algorithm << ' ' << distance;
    }
  }
}

/// √|x| with the sign of x: a full step leads from x to −x, where the cost is the same.
class EdgeSignedRoot : public BaseEdge<EdgeSignedRoot, 2, Vector<double, 2>, VertexPoint> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>&, const Vector<S, 2>& x) {
    using std::abs, std::sqrt;
    Vector<S, 2> e;
    for (int i = 0; i < 2; ++i) e[i] = x[i] < 0.0 ? S(-sqrt(S(abs(x[i])))) : S(sqrt(S(abs(x[i]))));
    return e;
  }
};

TEST(FalseConvergence, StepsToAndFroAreNoEnd) {
  auto registry = makeRegistry();
  registry->addEdge<EdgeSignedRoot>("EDGE_SIGNED_ROOT");
  for (const std::string algorithm : {"auto", "gn", "lm", "dogleg"}) {
    Graph graph(registry);
    for (int i = 0; i < 10; ++i) {
      graph.addVertex<VertexPoint>(i, Vector<double, 2>(4.0 + i, -3.0 - i));
      graph.addEdge<EdgeSignedRoot>({i}, Vector<double, 2>(0.0, 0.0), Matrix<double, 2, 2>::Identity());
    }
    const Summary summary = optimize(graph, {.maxIterations = 300, .algorithm = algorithm});
    if (algorithm == "gn") {
      EXPECT_EQ(summary.status, Status::stalled) << summary.reason;
      EXPECT_THAT(summary.reason, HasSubstr("to and fro"));
    } else {
      EXPECT_LT(summary.finalCost, 1e-3 * summary.initialCost) << algorithm << ": " << summary.reason;
    }
  }
}

/// A chain far from the origin, exact in itself, that two weak positions pull aside.
TEST(FalseConvergence, ARejectedStepIsNoEndWhileTheCostFollowsItsGradient) {
  for (const std::string algorithm : {"lm", "gn", "dogleg", "auto"}) {
    for (const double away : {0.0, 5e5, 5e6}) {
      Graph graph(builtinRegistry());
      constexpr int count = 20;
      for (int i = 0; i < count; ++i)
        graph.addVertex<VertexSE2>(i, SE2<double>(away + i, 0.1 * away + 0.5 * i, 0.05 * i));
      const auto pose = [&](int i) { return graph.vertex<VertexSE2>(i).estimate(); };
      for (int i = 0; i < count; ++i) {
        for (const int j : {i + 1, i + 5}) {
          if (j < count)
            graph.addEdge<EdgeSE2>({i, j}, pose(i).between(pose(j)), 0.01 * Matrix<double, 3, 3>::Identity());
        }
      }
      std::vector<Vector<double, 2>> places;
      for (const int k : {5, 11}) {
        places.emplace_back(pose(k).translation() + Vector<double, 2>(300.0, -150.0));
        auto& edge = graph.addEdge<EdgePriorSE2XY>({k}, places.back(), 1e-6 * Matrix<double, 2, 2>::Identity());
        if (algorithm == "auto") edge.setRobustKernel(RobustKernelHuber(1.0));
      }
      const Summary summary = optimize(graph, {.maxIterations = 1000, .algorithm = algorithm});
      EXPECT_EQ(summary.status, Status::converged) << algorithm << " " << away << ": " << summary.reason;
      EXPECT_LT((pose(5).translation() - places[0]).norm(), 0.01) << algorithm << " " << away << ": " << summary.reason;
      EXPECT_LT((pose(11).translation() - places[1]).norm(), 0.01) << algorithm << " " << away;
    }
  }
}

/// Its Jacobian has one sign wrong, so steps lower nothing until damping has made them too short to be seen.
class EdgeWrongSign : public BaseEdge<EdgeWrongSign, 2, Vector<double, 2>, VertexPoint> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& x) {
    return Vector<S, 2>(x - z);
  }
  static void linearizeOplus(const Vector<double, 2>&, const Vector<double, 2>&, Matrix<double, 2, 2>& J) {
    J << 1.0, 0.0, 0.0, -1.0;
  }
};

TEST(FalseConvergence, StepsThatDampingMadeShortAreNoEnd) {
  auto registry = makeRegistry();
  registry->addEdge<EdgeWrongSign>("EDGE_WRONG_SIGN");
  Graph graph(registry);
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.001, 1.0));
  graph.addEdge<EdgeWrongSign>({0}, Vector<double, 2>(0.0, 0.0), Matrix<double, 2, 2>::Identity());
  const Summary summary = optimize(graph, {.algorithm = "lm"});
  EXPECT_GT(summary.finalChi2, 1.9);  // else the case shows nothing
  EXPECT_NE(summary.status, Status::converged) << summary.reason;
}

}  // namespace
}  // namespace quiver
