// Jacobians that are not numbers, and a stopping rule that does not depend on the origin.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/util/error.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// The textbook range: 0/0 where the points coincide.
class EdgeDistance : public BaseEdge<EdgeDistance, 1, double, VertexPoint, VertexPoint> {
 public:
  static Vector<double, 1> computeError(const double& z, const Vector<double, 2>& a, const Vector<double, 2>& b) {
    return Vector<double, 1>((b - a).norm() - z);
  }
  static void linearizeOplus(const double&, const Vector<double, 2>& a, const Vector<double, 2>& b,
                             Matrix<double, 1, 2>& Ja, Matrix<double, 1, 2>& Jb) {
    Jb = (b - a).transpose() / (b - a).norm();
    Ja = -Jb;
  }
};

Graph coincident(bool withOther) {
  auto registry = makeRegistry();
  registry->addEdge<EdgeDistance>("EDGE_DISTANCE");
  Graph graph(registry);
  for (int id = 0; id < 3; ++id) graph.addVertex<VertexPoint>(id, Vector<double, 2>(1.0, 1.0));
  graph.addEdge<EdgeDistance>({0, 1}, 2.0, weight(1.0));
  if (withOther) graph.addEdge<EdgePoint>({2}, Vector<double, 2>(5.0, 5.0), weight2());
  return graph;
}

TEST(BadJacobian, IsANumericalFailureThatNamesTheEdge) {
  for (const bool withOther : {false, true}) {
    for (const char* algorithm : {"auto", "gn", "lm", "dogleg"}) {
      for (const char* solver : {"auto", "block", "dense", "eigen", "pcg"}) {
        Graph graph = coincident(withOther);
        const Summary summary = optimize(graph, {.algorithm = algorithm, .linearSolver = solver});
        EXPECT_EQ(summary.status, Status::numericalFailure) << algorithm << ' ' << solver;
        EXPECT_THAT(summary.reason, HasSubstr("the Jacobian of edge EDGE_DISTANCE 0 1 is not finite"));
        EXPECT_EQ(graph.vertex<VertexPoint>(1).estimate(), (Vector<double, 2>(1.0, 1.0)));
      }
    }
  }
}

/// An error that is another one at every call.
class EdgeRestless : public BaseEdge<EdgeRestless, 1, double, VertexPoint> {
 public:
  static Vector<double, 1> computeError(const double&, const Vector<double, 2>&) {
    static int calls = 0;
    return Vector<double, 1>(++calls % 7 * 1.0);
  }
};

TEST(BadJacobian, AnErrorThatJumpsEverywhereIsSaidToDoSo) {
  auto registry = makeRegistry();
  registry->addEdge<EdgeRestless>("EDGE_RESTLESS");
  Graph graph(registry);
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.0, 1.0));
  graph.addEdge<EdgeRestless>({0}, 2.0, weight(1.0));
  EXPECT_THAT(checkJacobians(graph).describe(),
              HasSubstr("EDGE_RESTLESS: 1 edges, nothing to compare: the error jumps"));
}

TEST(BadJacobian, IsFoundByTheCheck) {
  Graph graph = coincident(false);
  const JacobianReport report = checkJacobians(graph);
  EXPECT_EQ(report.worstDeviation(), std::numeric_limits<double>::infinity());
}

TEST(StoppingRules, DoNotDependOnTheOrigin) {
  std::vector<double> costs;
  for (const double origin : {0.0, 5e6, 1e8}) {
    Graph graph(makeRegistry());
    for (int id = 0; id < 20; ++id) {
      graph.addVertex<VertexPoint>(id, Vector<double, 2>(origin, 0.0));
      for (int k = 0; k < 5; ++k) {
        graph.addEdge<EdgePoint>({id}, Vector<double, 2>(origin + id + 0.3 * k * k, std::sin(k)), weight2())
            .setRobustKernel(RobustKernelCauchy(0.3));
      }
    }
    const Summary summary = optimize(graph, {.maxIterations = 2000});
    EXPECT_EQ(summary.status, Status::converged) << summary.reason;
    costs.push_back(summary.finalCost);
  }
  for (const double cost : costs) EXPECT_NEAR(cost, costs[0], 1e-6 * costs[0]);
}

}  // namespace
}  // namespace quiver
