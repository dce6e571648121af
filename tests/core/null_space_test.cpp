#include <quiver/core/algorithm/null_space.h>

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <quiver/core/algorithm/diagnosis.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/plugins/builtin.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/normal_equations.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A clock's offset and drift: a type that supplies no gauge generators.
class VertexClock : public BaseVertex<VertexClock, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
  static constexpr std::array tangent{"offset [s]", "drift [s/s]"};
};

/// Two clocks compared: at one time their offsets, over time their drifts too.
class EdgeCompared : public BaseEdge<EdgeCompared, 2, Vector<double, 2>, VertexClock, VertexClock> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& a, const Vector<S, 2>& b) {
    return b - a - z;
  }
};
/// Both drifts measured outright, offsets not.
class EdgeDrift : public BaseEdge<EdgeDrift, 1, double, VertexClock> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& z, const Vector<S, 2>& x) {
    return Vector<S, 1>(x[1] - z);
  }
};

Graph clocks(int count) {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexClock>("CLOCK");
  registry->addEdge<EdgeCompared>("COMPARED");
  registry->addEdge<EdgeDrift>("DRIFT");
  registerLinearSystems(*registry);
  Graph graph(registry);
  for (int id = 0; id < count; ++id) graph.addVertex<VertexClock>(id + 3, Vector<double, 2>(0.1 * id, -0.2 * id));
  for (int id = 0; id < count; ++id) {
    const int next = (id + 1) % count;
    graph.addEdge<EdgeCompared>({id + 3, next + 3}, Vector<double, 2>(0.01, 0.0), weight2(1.0 + id));
  }
  return graph;
}

/// The number of eigenvalues of D^-½ H D^-½ below 1e-9, dense, from products with unit vectors.
int denseNullity(const Problem& problem, const LinearSystem& system) {
  const auto n = static_cast<Eigen::Index>(problem.scalars());
  Eigen::MatrixXd H(n, n);
  std::vector<double> x(static_cast<std::size_t>(n), 0.0);
  for (Eigen::Index c = 0; c < n; ++c) {
    x[static_cast<std::size_t>(c)] = 1.0;
    system.multiply(x, {H.col(c).data(), static_cast<std::size_t>(n)});
    x[static_cast<std::size_t>(c)] = 0.0;
  }
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H * scale.asDiagonal());
  return static_cast<int>((eigen.eigenvalues().array() < 1e-9).count());
}

void expectNullSpace(Graph& graph, int expected) {
  Problem problem(graph, {});
  NormalEquations system(makeBlockSolver());
  system.analyze(problem, {}, 1);
  system.linearize(problem.state());
  const NullSpace space = findNullSpace(problem, system, {});
  ASSERT_TRUE(space.computed);
  EXPECT_EQ(static_cast<int>(space.directions.size()), expected);
  EXPECT_EQ(denseNullity(problem, system), expected);
  std::vector<double> product(static_cast<std::size_t>(problem.scalars()));
  for (const std::vector<double>& direction : space.directions) {
    system.multiply(direction, product);
    double quotient = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < product.size(); ++i) {
      quotient += direction[i] * product[i];
      norm += direction[i] * direction[i] * system.diagonal()[i];
    }
    EXPECT_NEAR(norm, 1.0, 1e-9);
    EXPECT_LT(quotient, 1e-10);
  }
}

TEST(NullSpace, IsThatOfADenseEigenproblem) {
  Graph free = clocks(40);
  expectNullSpace(free, 2);
  free.addEdge<EdgeDrift>({7}, 0.0, weight(1.0));
  expectNullSpace(free, 1);
  free.vertex<VertexClock>(9).setFixed(true);
  expectNullSpace(free, 0);
  Graph ring = ringGraph<EdgeRangeDual>(30, 6);
  expectNullSpace(ring, 3);
}

/// What is said when the factorisation meets a pivot of zero at the last variable.
std::string diagnosis(Graph& graph) {
  Problem problem(graph, {});
  NormalEquations system(makeBlockSolver());
  system.analyze(problem, {}, 1);
  system.linearize(problem.state());
  LinearOutcome outcome;
  outcome.kind = LinearOutcome::Kind::notPositiveDefinite;
  outcome.variable = problem.variables() - 1;
  outcome.coordinate = 0;
  return diagnoseFailure(problem, system, outcome, false);
}

TEST(NullSpace, TheDiagnosisNamesVertexTypeAndDirectionsOfAnyType) {
  Graph graph = clocks(40);
  EXPECT_THAT(diagnosis(graph),
              AllOf(HasSubstr("vertex 3 (CLOCK)"), HasSubstr("offset [s]; drift [s/s]"), HasSubstr("39 other vertices"),
                    HasSubstr("2 null directions"), HasSubstr("--fix 3")));
}

TEST(NullSpace, TheDiagnosisNamesTheOneDirectionThatIsFree) {
  Graph graph = clocks(12);
  graph.addEdge<EdgeDrift>({7}, 0.0, weight(1.0));
  EXPECT_THAT(diagnosis(graph), AllOf(HasSubstr("vertex 3 (CLOCK) is not constrained in: offset [s], moving"),
                                      HasSubstr("1 null direction;")));
}

TEST(NullSpace, GaussNewtonDoesNotGoOnWithoutAGauge) {
  // A total weight of 4 has an exact root: elimination is exact and the last pivots are zero.
  Graph graph = clocks(2);
  graph.addEdge<EdgeCompared>({3, 4}, Vector<double, 2>(0.0, 0.0), weight2(1.0));
  const Summary summary = optimize(graph, {.algorithm = "gn", .gauge = GaugePolicy::free});
  EXPECT_EQ(summary.status, Status::numericalFailure);
  EXPECT_THAT(summary.reason, AllOf(HasSubstr("CLOCK"), HasSubstr("offset [s]; drift [s/s]")));
}

}  // namespace
}  // namespace quiver
