#include <quiver/smoothing/marginals.h>

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <quiver/core/util/error.h>
#include <quiver/quiver.h>
#include <quiver/solvers/backends/eigen_solver.h>
#include <quiver/solvers/normal_equations.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/edge_se2_prior.h>
#include <quiver/types_slam2d/edge_se2_xy.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver::test {
namespace {

using Eigen::MatrixXd;

Matrix<double, 3, 3> weights(double translation, double rotation) {
  return Vector<double, 3>(translation, translation, rotation).asDiagonal();
}

/// A walk with a loop and landmarks that are seen twice or more; every vertex off its place.
Graph walk(int poses, bool prior, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Graph graph(builtinRegistry());
  std::vector<SE2<double>> truth;
  for (int i = 0; i < poses; ++i) {
    truth.push_back(i == 0 ? SE2<double>() : truth.back() * SE2<double>(1.0, 0.1 * normal(random), 0.3));
    graph.addVertex<VertexSE2>(i, truth.back().retract(Vector<double, 3>(0.02, -0.01, 0.01) * normal(random)));
  }
  for (int i = 0; i + 1 < poses; ++i)
    graph.addEdge<EdgeSE2>({i, i + 1}, truth[i].between(truth[i + 1]), weights(100, 900));
  graph.addEdge<EdgeSE2>({0, poses - 1}, truth[0].between(truth[poses - 1]), weights(50, 400));
  for (int l = 0; l < poses / 2; ++l) {
    const Vector<double, 2> place(3.0 * normal(random), 3.0 * normal(random));
    graph.addVertex<VertexXY>(1000 + l, Vector<double, 2>(place + Vector<double, 2>(0.05, 0.02)));
    for (int i = l; i < std::min(poses, l + 3); ++i) {
      graph.addEdge<EdgeSE2XY>({i, 1000 + l}, Vector<double, 2>(truth[i].inverse() * place),
                               Matrix<double, 2, 2>(Vector<double, 2>(25.0, 16.0).asDiagonal()));
    }
  }
  if (prior) graph.addEdge<EdgePriorSE2>({1}, truth[1], weights(4.0, 10.0));
  return graph;
}

/// H⁻¹ by columns of H, which come from products, and a dense inverse: nothing of it knows the sparse factor.
MatrixXd denseInverse(const Problem& problem) {
  NormalEquations equations(makeEigenSolver());
  equations.analyze(problem, Options(), 1);
  equations.linearize(problem.state());
  const auto scalars = static_cast<Eigen::Index>(problem.scalars());
  MatrixXd H(scalars, scalars);
  std::vector<double> unit(static_cast<std::size_t>(scalars), 0.0);
  std::vector<double> column(unit.size());
  for (Eigen::Index i = 0; i < scalars; ++i) {
    unit[static_cast<std::size_t>(i)] = 1.0;
    equations.multiply(unit, column);
    unit[static_cast<std::size_t>(i)] = 0.0;
    H.col(i) = Eigen::Map<const Eigen::VectorXd>(column.data(), scalars);
  }
  return H.inverse();
}

void expectDense(Graph& graph, const Options& options) {
  const Marginals marginals(graph, options);
  ASSERT_TRUE(marginals.ok()) << marginals.reason();
  const Problem problem(graph, {options.level, options.free, 1});
  const MatrixXd dense = denseInverse(problem);
  std::vector<std::int64_t> ids;
  for (int a = 0; a < problem.variables(); ++a) {
    ids.push_back(problem.vertex(problem.slotOfVariable(a)).id());
    for (int b = 0; b < problem.variables(); ++b) {
      const std::int64_t id = problem.vertex(problem.slotOfVariable(b)).id();
      const MatrixXd block = marginals.covariance(ids.back(), id);
      const MatrixXd expected =
          dense.block(problem.offset(a), problem.offset(b), problem.dimension(a), problem.dimension(b));
      EXPECT_LE((block - expected).norm(), 1e-9 * dense.norm()) << ids.back() << " " << id;
    }
  }
  EXPECT_LE((marginals.joint(ids) - dense).norm(), 1e-9 * dense.norm());
}

TEST(Marginals, AreTheDenseInverse) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Graph graph = walk(12, true, seed);
    (void)optimize(graph);
    expectDense(graph, Options());
  }
}

TEST(Marginals, AreTheSameForAnyNumberOfThreads) {
  Graph graph = walk(40, true);
  (void)optimize(graph);
  const Marginals one(graph, {.threads = 1});
  const Marginals many(graph, {.threads = 3});
  for (const std::int64_t id : one.vertices()) EXPECT_EQ(one.covariance(id), many.covariance(id)) << id;
}

/// P ← A P Aᵀ + Ω⁻¹ along a chain whose errors are zero, A by differences of the group alone.
TEST(Marginals, OfAChainPropagate) {
  Graph graph(builtinRegistry());
  const SE2<double> step(1.2, -0.3, 0.4);
  const Matrix<double, 3, 3> information = weights(40.0, 250.0);
  SE2<double> pose;
  graph.addVertex<VertexSE2>(0, pose).setFixed(true);
  constexpr int length = 6;
  for (int i = 1; i < length; ++i) {
    pose = pose * step;
    graph.addVertex<VertexSE2>(i, pose);
    graph.addEdge<EdgeSE2>({i - 1, i}, step, information);
  }
  const Marginals marginals(graph);
  ASSERT_TRUE(marginals.ok()) << marginals.reason();
  Matrix<double, 3, 3> A;
  for (int k = 0; k < 3; ++k) {
    constexpr double h = 1e-6;
    Vector<double, 3> delta = Vector<double, 3>::Zero();
    delta[k] = h;
    const Vector<double, 3> forward = (step.inverse() * SE2<double>().retract(delta) * step).toVector();
    delta[k] = -h;
    A.col(k) = (forward - (step.inverse() * SE2<double>().retract(delta) * step).toVector()) / (2.0 * h);
  }
  Matrix<double, 3, 3> P = Matrix<double, 3, 3>::Zero();
  for (int i = 1; i < length; ++i) {
    P = A * P * A.transpose() + information.inverse();
    EXPECT_LE((marginals.covariance(i) - P).norm(), 1e-8 * P.norm()) << i;
  }
  // What lies between two poses is independent of what came before.
  const MatrixXd joint = marginals.joint(std::vector<std::int64_t>{2, 3});
  const MatrixXd between =
      joint.block(3, 3, 3, 3) - joint.block(3, 0, 3, 3) * joint.block(0, 0, 3, 3).inverse() * joint.block(0, 3, 3, 3);
  EXPECT_LE((between - information.inverse()).norm(), 1e-9);
}

/// The heading at the end of a chain has the variance of all its steps. Where rounding spoils it, the estimate of the
/// error says so.
TEST(Marginals, TellHowFarRoundingSpoilsThem) {
  for (const int length : {100, 1000, 10000, 100000}) {
    Graph graph(builtinRegistry());
    SE2<double> pose;
    for (int i = 0; i < length; ++i) {
      graph.addVertex<VertexSE2>(i, pose);
      const SE2<double> step(1.0, 0.0, 3e-3 * std::sin(0.01 * i));
      if (i > 0)
        graph.addEdge<EdgeSE2>({i - 1, i}, graph.vertex<VertexSE2>(i - 1).estimate().between(pose), weights(100, 900));
      pose = pose * step;
    }
    const Marginals marginals(graph);
    ASSERT_TRUE(marginals.ok()) << marginals.reason();
    const double expected = (length - 1) / 900.0;
    const double error = std::abs(marginals.covariance(length - 1)(2, 2) - expected) / expected;
    EXPECT_LE(error, 10.0 * marginals.relativeError() + 1e-12) << length;
    EXPECT_LE(marginals.relativeError(), 1e5 * error + 1e-9) << length;
    if (length <= 1000) {
      EXPECT_LT(marginals.relativeError(), 1e-3);
    }
    if (length == 100000) {
      EXPECT_GT(marginals.relativeError(), 0.1);
    }
  }
}

TEST(Marginals, RobustKernelsCountByTheirWeight) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>(3.0, 4.0, 0.0));
  graph.addEdge<EdgePriorSE2>({0}, SE2<double>(), weights(1.0, 1.0)).setRobustKernel(RobustKernelHuber(1.0));
  const Marginals marginals(graph);
  ASSERT_TRUE(marginals.ok());
  // ‖e‖ = 5, so ρ' = 1/5.
  EXPECT_LE((marginals.covariance(0) - 5.0 * MatrixXd::Identity(3, 3)).norm(), 1e-12);
}

TEST(Marginals, TheGaugeIsHeldAndHasNoCovariance) {
  Graph graph = walk(10, false);
  (void)optimize(graph);
  const Marginals marginals(graph);
  ASSERT_TRUE(marginals.ok()) << marginals.reason();
  EXPECT_THAT(marginals.gauge().fixed, testing::ElementsAre(0));
  EXPECT_EQ(marginals.covariance(0), MatrixXd::Zero(3, 3));
  EXPECT_EQ(marginals.covariance(1000, 0), MatrixXd::Zero(2, 3));
  EXPECT_GT(marginals.covariance(5).diagonal().minCoeff(), 0.0);
  Graph fixed(graph);
  fixed.vertex<VertexSE2>(0).setFixed(true);
  expectDense(fixed, Options());
  EXPECT_LE((Marginals(fixed).covariance(7) - marginals.covariance(7)).norm(), 1e-12);
}

TEST(Marginals, DirectionsHeldInPartAreZero) {
  Graph graph = walk(6, true);
  graph.vertex<VertexSE2>(2).setFixedDirections(1u << 1);
  const Marginals marginals(graph);
  ASSERT_TRUE(marginals.ok()) << marginals.reason();
  const MatrixXd own = marginals.covariance(2);
  EXPECT_EQ(own.row(1), MatrixXd::Zero(1, 3));
  EXPECT_EQ(own.col(1), MatrixXd::Zero(3, 1));
  EXPECT_GT(own(0, 0), 0.0);
  EXPECT_EQ(marginals.covariance(4, 2).col(1), MatrixXd::Zero(3, 1));
}

TEST(Marginals, WhatIsNotConstrainedDoesNotReachTheOthers) {
  Graph graph = walk(6, true);
  const Marginals before(graph);
  graph.addVertex<VertexXY>(78, Vector<double, 2>(1.0, 2.0));
  // Seen in one direction only.
  graph.addEdge<EdgeSE2XY>({3, 78}, Vector<double, 2>(1.0, 0.5),
                           Matrix<double, 2, 2>(Vector<double, 2>(1.0, 0.0).asDiagonal()));
  const Marginals marginals(graph);
  EXPECT_TRUE(marginals.ok());
  EXPECT_THAT(marginals.undetermined(), testing::ElementsAre(78));
  EXPECT_THAT([&] { marginals.covariance(78); }, testing::ThrowsMessage<GraphError>(testing::HasSubstr("vertex 78")));
  ASSERT_EQ(marginals.vertices(), before.vertices());
  for (const std::int64_t id : before.vertices())
    EXPECT_LE((marginals.covariance(id) - before.covariance(id)).norm(), 1e-9 * before.covariance(id).norm()) << id;
}

TEST(Marginals, AFreeGaugeLeavesNothing) {
  Graph graph = walk(6, false);
  const Marginals marginals(graph, {.gauge = GaugePolicy::free});
  EXPECT_FALSE(marginals.ok());
  EXPECT_THAT(marginals.reason(), testing::HasSubstr("may move as a whole"));
  EXPECT_THROW(marginals.covariance(3), GraphError);
  EXPECT_THAT(marginals.vertices(), testing::IsEmpty());
}

/// A long walk that hangs on a fixed pose by one point alone turns about it, whatever the unit of length; elimination
/// leaves far more of that than rounding.
TEST(Marginals, AHingeLeavesItsMapUndetermined) {
  for (const double unit : {1.0, 1e6, 1e-6}) {
    for (const int poses : {20, 3000}) {
      Graph graph(builtinRegistry());
      std::mt19937 random(9);
      std::normal_distribution<double> normal;
      const Matrix<double, 3, 3> information =
          Vector<double, 3>(100.0 / unit / unit, 44.0 / unit / unit, 900.0).asDiagonal();
      const Matrix<double, 2, 2> sighting = 25.0 / unit / unit * Matrix<double, 2, 2>::Identity();
      SE2<double> pose;
      for (int i = 0; i < poses; ++i) {
        graph.addVertex<VertexSE2>(i, pose);
        pose =
            pose * SE2<double>((1.0 + 0.1 * normal(random)) * unit, 0.1 * normal(random) * unit, 0.2 * normal(random));
      }
      const auto at = [&](int i) { return graph.vertex<VertexSE2>(i).estimate(); };
      for (int i = 0; i + 1 < poses; ++i) graph.addEdge<EdgeSE2>({i, i + 1}, at(i).between(at(i + 1)), information);
      for (int i = 0; i + 40 < poses; i += 7)
        graph.addEdge<EdgeSE2>({i, i + 40}, at(i).between(at(i + 40)), information);
      // Pose 100000 is fixed and sees the point in which the walk is hinged; 100002 hangs on it firmly.
      const Vector<double, 2> hinge(0.5 * unit, -0.3 * unit);
      graph.addVertex<VertexSE2>(100000, SE2<double>(-1.0 * unit, 0.0, 0.3)).setFixed(true);
      graph.addVertex<VertexXY>(100001, hinge);
      graph.addVertex<VertexSE2>(100002, SE2<double>(-2.0 * unit, 0.0, 0.1));
      const SE2<double> fixed(-1.0 * unit, 0.0, 0.3);
      graph.addEdge<EdgeSE2XY>({100000, 100001}, fixed.actInverse(hinge), sighting);
      graph.addEdge<EdgeSE2XY>({0, 100001}, at(0).actInverse(hinge), sighting);
      graph.addEdge<EdgeSE2>({100000, 100002}, fixed.between(SE2<double>(-2.0 * unit, 0.0, 0.1)), information);
      const Marginals marginals(graph);
      EXPECT_TRUE(marginals.ok()) << marginals.reason();
      EXPECT_EQ(marginals.undetermined().size(), static_cast<std::size_t>(poses)) << unit << " " << poses;
      EXPECT_THAT(marginals.vertices(), testing::ElementsAre(100001, 100002)) << unit << " " << poses;
      if (!marginals.ok() || marginals.vertices().size() != 2) continue;
      EXPECT_LE((marginals.covariance(100001) - sighting.inverse()).norm(), 1e-9 * sighting.inverse().norm());
      EXPECT_LE((marginals.covariance(100002) - information.inverse()).norm(), 1e-9 * information.inverse().norm());
    }
  }
}

TEST(Marginals, APointOfOpenDepthIsUndeterminedBesideFixedPosesToo) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>()).setFixed(true);
  graph.addVertex<VertexXY>(1, Vector<double, 2>(3.0, 1.0));
  graph.addEdge<EdgeSE2XY>({0, 1}, Vector<double, 2>(3.0, 1.0),
                           Matrix<double, 2, 2>(Vector<double, 2>(0.0, 4.0).asDiagonal()));
  const Marginals marginals(graph);
  EXPECT_FALSE(marginals.ok());
  EXPECT_THAT(marginals.undetermined(), testing::ElementsAre(1));
}

/// Two walks, of which one floats: its vertices alone are undetermined.
TEST(Marginals, AFloatingPartIsLeftOut) {
  Graph graph = walk(5, true);
  for (int i = 0; i < 3; ++i) graph.addVertex<VertexSE2>(50 + i, SE2<double>(i, 5.0, 0.1));
  for (int i = 0; i < 2; ++i) graph.addEdge<EdgeSE2>({50 + i, 51 + i}, SE2<double>(1.0, 0.0, 0.0), weights(1, 1));
  const Marginals marginals(graph, {.gauge = GaugePolicy::free});
  EXPECT_TRUE(marginals.ok());
  EXPECT_THAT(marginals.undetermined(), testing::ElementsAre(50, 51, 52));
  EXPECT_THAT(marginals.vertices(), testing::Contains(4));
}

TEST(Marginals, VerticesWithoutCovarianceAreRefusedByName) {
  Graph graph = walk(6, true);
  graph.addVertex<VertexSE2>(77, SE2<double>());
  const Marginals marginals(graph);
  ASSERT_TRUE(marginals.ok()) << marginals.reason();
  EXPECT_THAT([&] { marginals.covariance(77); }, testing::ThrowsMessage<GraphError>(testing::HasSubstr("vertex 77")));
  EXPECT_THAT([&] { marginals.covariance(5, 4711); }, testing::ThrowsMessage<GraphError>(testing::HasSubstr("4711")));
  EXPECT_THAT(marginals.vertices(), testing::Not(testing::Contains(77)));
  EXPECT_THAT(marginals.undetermined(), testing::ElementsAre(77));
}

TEST(Marginals, APartOfTheGraphIsRelativeToTheRest) {
  Graph graph = walk(10, true);
  (void)optimize(graph);
  const Options part{.free = {3, 4, 1001}};
  expectDense(graph, part);
  const Marginals marginals(graph, part);
  EXPECT_EQ(marginals.covariance(9), MatrixXd::Zero(3, 3));
  EXPECT_THAT(marginals.vertices(), testing::ElementsAre(3, 4, 1001));
}

TEST(Marginals, EndEarlyWhenAskedAndWhereMemoryIsShort) {
  Graph graph = walk(30, true);
  std::stop_source source;
  source.request_stop();
  const Marginals stopped(graph, {.stopToken = source.get_token()});
  EXPECT_FALSE(stopped.ok());
  EXPECT_THAT(stopped.reason(), testing::HasSubstr("interrupted"));
  EXPECT_THROW(stopped.covariance(3), GraphError);
  EXPECT_THAT(stopped.vertices(), testing::IsEmpty());
  EXPECT_FALSE(Marginals(graph, {.timeLimit = 0.0}).ok());
  const Marginals large(graph, {.memoryLimit = 1000});
  EXPECT_FALSE(large.ok());
  EXPECT_THAT(large.reason(), testing::HasSubstr("bytes"));
  EXPECT_TRUE(Marginals(graph, {.memoryLimit = 100'000'000}).ok());
}

TEST(Marginals, OfNothingAreNothing) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>()).setFixed(true);
  const Marginals marginals(graph);
  EXPECT_TRUE(marginals.ok());
  EXPECT_THAT(marginals.vertices(), testing::IsEmpty());
}

TEST(Marginals, HoldWhatFixedVerticesLeaveFreeIfAskedTo) {
  // The world may turn about a point.
  Graph point = walk(12, false);
  point.addVertex<VertexXY>(5000, Vector<double, 2>(0.0, 0.0)).setFixed(true);
  point.addEdge<EdgeSE2XY>({0, 5000}, Vector<double, 2>(1.0, 0.0), Matrix<double, 2, 2>::Identity());
  EXPECT_FALSE(Marginals(point, {}).ok());
  const Marginals held(point, {.gauge = GaugePolicy::fix});
  EXPECT_TRUE(held.ok()) << held.reason();
  EXPECT_EQ(held.gauge().fixed.size(), 1u);
}

TEST(Marginals, SayThatTheyWereStopped) {
  Graph graph = walk(12, true);
  const Marginals stopped(graph, {.timeLimit = 0.0});
  EXPECT_TRUE(stopped.stopped());
  EXPECT_THAT(stopped.reason(), ::testing::HasSubstr("time limit"));
  std::stop_source source;
  source.request_stop();
  EXPECT_THAT(Marginals(graph, {.stopToken = source.get_token()}).reason(), ::testing::HasSubstr("interrupted"));
  EXPECT_FALSE(Marginals(graph).stopped());
}

}  // namespace
}  // namespace quiver::test
