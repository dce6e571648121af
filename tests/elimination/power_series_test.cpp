#include <quiver/solvers/elimination/power_series.h>

#include <random>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/solvers/backends/power_solver.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "projections.h"

namespace quiver::test {
namespace {

/// Terms fall to this share of the sum, in systems whose terms at least halve.
constexpr double seriesTolerance = 1e-12;
constexpr double solutionTolerance = 1e-10;

struct Arrow {
  Eigen::MatrixXd U;
  Eigen::MatrixXd S;

  Arrow() = default;
  /// H = JᵀJ + D with a diagonal of blocks to eliminate.
  explicit Arrow(std::mt19937& random, double damping) {
    constexpr int kept = 12, points = 30;
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(3 * points, kept, [&] { return normal(random); });
    const Eigen::MatrixXd P = Eigen::MatrixXd::NullaryExpr(
        3 * points, points, [&](Eigen::Index r, Eigen::Index c) { return r / 3 == c ? normal(random) : 0.0; });
    U = J.transpose() * J;
    U.diagonal() *= 1.0 + damping;
    Eigen::MatrixXd V = P.transpose() * P;
    V.diagonal() *= 1.0 + damping;
    const Eigen::MatrixXd W = J.transpose() * P;
    S = U - W * V.inverse() * W.transpose();
  }

  LinearOutcome solve(PowerSeries series, Eigen::VectorXd& x) const {
    return series.solve(
        {x.data(), static_cast<std::size_t>(x.size())},
        [&](std::span<double> v) {
          Eigen::Map<Eigen::VectorXd> mapped(v.data(), static_cast<Eigen::Index>(v.size()));
          mapped = U.llt().solve(Eigen::VectorXd(mapped));
          return SolverStatus{};
        },
        [&](std::span<const double> v, std::span<double> out) {
          Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size())) =
              S * Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
        },
        {});
  }
};

TEST(PowerSeries, SumsToTheSolution) {
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) {
    const Arrow arrow(random, 1.0);
    const Eigen::VectorXd s = Eigen::VectorXd::Random(arrow.S.rows());
    Eigen::VectorXd x = s;
    ASSERT_TRUE(arrow.solve(PowerSeries({seriesTolerance, 1000}), x).ok());
    const Eigen::VectorXd exact = arrow.S.llt().solve(s);
    EXPECT_LE((x - exact).norm(), solutionTolerance * exact.norm());
  }
}

TEST(PowerSeries, EveryTermBringsItNearer) {
  std::mt19937 random(5);
  const Arrow arrow(random, 1e-3);
  const Eigen::VectorXd s = Eigen::VectorXd::Random(arrow.S.rows());
  const Eigen::VectorXd exact = arrow.S.llt().solve(s);
  double before = exact.dot(arrow.S * exact);
  for (int terms = 1; terms < 12; ++terms) {
    Eigen::VectorXd x = s;
    const LinearOutcome outcome = arrow.solve(PowerSeries({0.0, terms}), x);
    EXPECT_TRUE(outcome.ok());
    EXPECT_EQ(outcome.iterations, terms - 1);
    EXPECT_GT(x.dot(s), 0.0) << "a step downhill";
    const double error = (x - exact).dot(arrow.S * (x - exact));
    EXPECT_LT(error, before);
    before = error;
  }
}

/// Edges that join three kept vertices: against the diagonal blocks alone the series would diverge.
TEST(PowerSeries, ConvergesWhereEdgesJoinSeveralKeptVertices) {
  constexpr int kept = 6;
  Arrow arrow;
  arrow.U = 0.3 * Eigen::MatrixXd::Identity(kept, kept);
  for (int i = 0; i < kept; ++i) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(kept);
    for (int k = 0; k < 3; ++k) row[(i + k) % kept] = 1.0;
    arrow.U += row * row.transpose();
  }
  arrow.S = arrow.U;
  arrow.U = Eigen::MatrixXd(arrow.U.diagonal().asDiagonal());
  const Eigen::VectorXd s = Eigen::VectorXd::Random(kept);
  Eigen::VectorXd x = s;
  ASSERT_TRUE(arrow.solve(PowerSeries({seriesTolerance, 3000, 3.0}), x).ok());
  const Eigen::VectorXd exact = arrow.S.llt().solve(s);
  EXPECT_LE((x - exact).norm(), solutionTolerance * exact.norm());
}

TEST(PowerSolver, SolvesWhatIsWellConditioned) {
  std::mt19937 random(6);
  const BlockLayout layout(std::vector<int>{3, 2, 4});
  const auto pattern = std::make_shared<const BlockPattern>(
      BlockPattern::fromPairs(layout, std::vector<std::pair<int, int>>{{0, 1}, {1, 2}}));
  BlockMatrix matrix(pattern);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(9, 9);
  std::normal_distribution<double> normal;
  for (int column = 0; column < pattern->blocks(); ++column) {
    for (std::int64_t k = pattern->columnBegin(column); k < pattern->columnEnd(column); ++k) {
      const int row = pattern->row(k);
      const int rows = layout.dimension(row);
      const int columns = layout.dimension(column);
      Eigen::MatrixXd block = 0.2 * Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
      if (row == column) block = Eigen::MatrixXd(block * block.transpose()) + Eigen::MatrixXd::Identity(rows, rows);
      Eigen::Map<Eigen::MatrixXd>(matrix.block(k), rows, columns) = block;
      dense.block(layout.offset(row), layout.offset(column), rows, columns) = block;
      dense.block(layout.offset(column), layout.offset(row), columns, rows) = block.transpose();
    }
  }
  const std::vector<double> damping(9, 0.5);
  dense.diagonal().array() += 0.5;
  const auto solver = makePowerSolver(seriesTolerance, 10000);
  solver->analyze(pattern, 1);
  ASSERT_TRUE(solver->factorize(matrix, damping).ok());
  const Eigen::VectorXd b = Eigen::VectorXd::Random(9);
  Eigen::VectorXd x = b;
  ASSERT_TRUE(solver->solve({x.data(), 9}).ok());
  const Eigen::VectorXd exact = dense.llt().solve(b);
  EXPECT_LE((x - exact).norm(), solutionTolerance * exact.norm());
  EXPECT_GT(solver->statistics().iterations, 0);
}

TEST(PowerSeries, IsOfferedForBundles) {
  Graph reference = bundle({});
  const Summary expected = optimize(reference, {.algorithm = "lm", .threads = 1});
  Graph graph = bundle({});
  const Summary summary =
      optimize(graph, {.maxIterations = 200, .algorithm = "lm", .linearSolver = "power", .threads = 1});
  EXPECT_EQ(summary.plan.linearSolver, "power");
  EXPECT_GT(summary.plan.eliminated, 0);
  // Steps of low accuracy: much of the way, not the last digits.
  EXPECT_LE(summary.finalChi2, 1.01 * expected.finalChi2) << summary.reason;
}

}  // namespace
}  // namespace quiver::test
