#include <quiver/solvers/elimination/schur_system.h>

#include <gtest/gtest.h>

#include "mixed_graph.h"
#include "projections.h"

namespace quiver::test {
namespace {

/// DESIGN: backward error of solutions, and forward error at condition numbers up to 1e6.
constexpr double backwardTolerance = 1e-13;
constexpr double forwardTolerance = 1e-8;
constexpr double largestCondition = 1e6;
/// Sums of up to some hundred products in another order.
constexpr double sumTolerance = 1e-12;

EliminationChoice choiceOf(std::vector<char> eliminated) {
  EliminationChoice choice;
  for (const char chosen : eliminated) choice.count += chosen;
  choice.eliminated = std::move(eliminated);
  return choice;
}

Eigen::VectorXd randomVector(Eigen::Index size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::VectorXd::NullaryExpr(size, [&] { return normal(random); });
}

std::span<const double> spanOf(const Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }
std::span<double> spanOf(Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

/// Compares everything a linear system answers with a dense one.
void compareWithDense(const Problem& problem, SchurSystem& system, std::mt19937& random) {
  const DenseSystem dense(problem);
  system.linearize(problem.state());
  const Eigen::Index size = problem.scalars();
  const double scale = std::max(1.0, dense.H.cwiseAbs().maxCoeff());
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto at = static_cast<std::size_t>(i);
    ASSERT_NEAR(system.gradient()[at], dense.g[i], sumTolerance * (1.0 + dense.g.cwiseAbs().maxCoeff()));
    ASSERT_NEAR(system.diagonal()[at], dense.H(i, i), sumTolerance * scale);
  }
  const Eigen::VectorXd x = randomVector(size, random);
  Eigen::VectorXd y(size);
  system.multiply(spanOf(x), spanOf(y));
  ASSERT_LE((y - dense.H * x).cwiseAbs().maxCoeff(), sumTolerance * scale * x.cwiseAbs().sum());

  for (const bool damped : {false, true}) {
    Eigen::VectorXd damping = Eigen::VectorXd::Zero(size);
    if (damped) damping = 0.1 * dense.H.diagonal() + 0.5 * randomVector(size, random).cwiseAbs();
    const Eigen::MatrixXd H = dense.H + Eigen::MatrixXd(damping.asDiagonal());
    Eigen::VectorXd delta(size);
    const LinearOutcome outcome =
        system.solve(damped ? spanOf(std::as_const(damping)) : std::span<const double>(), spanOf(delta), {});
    ASSERT_TRUE(outcome.ok());
    const double norm = H.norm() * delta.norm() + dense.g.norm();
    ASSERT_LE((H * delta + dense.g).norm(), backwardTolerance * norm);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(H);
    const double condition = svd.singularValues()[0] / svd.singularValues()[size - 1];
    if (condition > largestCondition) continue;
    const Eigen::VectorXd expected = -H.ldlt().solve(dense.g);
    ASSERT_LE((delta - expected).norm(), forwardTolerance * std::max(1e-3, expected.norm()));
  }
}

class RandomGraphs : public testing::TestWithParam<int> {};

TEST_P(RandomGraphs, SolveAsADenseSystemDoes) {
  constexpr int graphs = 1000;
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  int eliminated = 0;
  for (int i = 0; i < graphs; ++i) {
    MixedShape shape;
    shape.vertices = 2 + static_cast<int>(random() % 14);
    shape.edges = static_cast<int>(random() % 50);
    shape.fixed = i % 3 == 0 ? 0.2 : 0.0;
    shape.held = i % 5 == 0 ? 0.3 : 0.0;
    Graph graph = randomMixedGraph(shape, random);
    const Problem problem(graph, {});
    if (problem.variables() == 0) continue;
    EliminationChoice choice = choiceOf(randomIndependentSet(problem, random));
    eliminated += static_cast<int>(choice.count);
    SchurSystem system(nullptr, std::move(choice));
    system.analyze(problem, {}, 1);
    compareWithDense(problem, system, random);
    if (HasFatalFailure()) FAIL() << "graph " << i;
  }
  EXPECT_GT(eliminated, graphs);
}

TEST(SchurSystem, ADroppedTrialLeavesNothingBehind) {
  Graph graph = bundle({});
  Problem problem(graph, {});
  Options options;
  options.elimination = EliminationPolicy::types;
  options.eliminatedTypes = {"POINT"};
  EliminationChoice choice = chooseElimination(problem, options);
  ASSERT_GT(choice.count, 0);
  SchurSystem system(nullptr, std::move(choice));
  system.analyze(problem, options, 1);
  const auto numbers = [&] {
    std::vector<double> all(system.gradient().begin(), system.gradient().end());
    all.insert(all.end(), system.diagonal().begin(), system.diagonal().end());
    return all;
  };
  const auto move = [&](double step) {
    problem.retract(std::vector<double>(static_cast<std::size_t>(problem.scalars()), step));
  };
  system.linearize(problem.state());
  const std::vector<double> before = numbers();
  move(0.01);
  ASSERT_TRUE(system.tryState(problem.trial()));
  system.dropTrial();
  EXPECT_EQ(numbers(), before);
  // The next trial lies where the dropped one lay; it is accepted after its cost alone was computed.
  move(-0.002);
  problem.acceptTrial();
  system.linearize(problem.state());
  const std::vector<double> taken = numbers();
  system.linearize(problem.state());
  EXPECT_EQ(numbers(), taken);
  EXPECT_NE(taken, before);
}

INSTANTIATE_TEST_SUITE_P(TenThousand, RandomGraphs, testing::Range(1, 11));

}  // namespace
}  // namespace quiver::test
