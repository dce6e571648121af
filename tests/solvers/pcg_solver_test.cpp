#include <quiver/solvers/backends/pcg_solver.h>

#include <gtest/gtest.h>

#include <quiver/core/util/error.h>
#include <tests/solvers/random_system.h>

namespace quiver::test {
namespace {

std::span<double> spanOf(Eigen::VectorXd& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

std::shared_ptr<const BlockPattern> patternOf(const BlockMatrix& matrix) {
  return std::make_shared<const BlockPattern>(matrix.pattern());
}

/// √(vᵀM⁻¹v), M the diagonal blocks of a dense matrix.
double preconditionedNorm(const BlockMatrix& matrix, const Eigen::MatrixXd& dense, const Eigen::VectorXd& v) {
  double sum = 0.0;
  for (int block = 0; block < matrix.layout().blocks(); ++block) {
    const auto at = matrix.layout().offset(block);
    const auto n = matrix.layout().dimension(block);
    sum += v.segment(at, n).dot(dense.block(at, at, n, n).ldlt().solve(v.segment(at, n)));
  }
  return std::sqrt(sum);
}

TEST(Pcg, EndsAtTheToleranceAskedAndNoEarlier) {
  std::mt19937 random(5);
  const BlockMatrix matrix = randomSystem(Shape::grid, 400, {2, 3, 6}, random);
  const Eigen::MatrixXd dense = toDense(matrix);
  const Eigen::VectorXd b = randomVector(dense.rows(), random);
  int before = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-8, 1e-12}) {
    const auto solver = makePcgSolver({.tolerance = tolerance});
    solver->analyze(patternOf(matrix), 1);
    ASSERT_TRUE(solver->factorize(matrix, {}).ok());
    Eigen::VectorXd x = b;
    ASSERT_TRUE(solver->solve(spanOf(x)).ok());
    const double left = preconditionedNorm(matrix, dense, b - dense * x) / preconditionedNorm(matrix, dense, b);
    EXPECT_LE(left, 1.001 * tolerance);
    EXPECT_GT(left, 1e-3 * tolerance) << "it should stop once it is there";
    EXPECT_GT(solver->statistics().iterations, before);
    before = solver->statistics().iterations;
  }
}

TEST(Pcg, IteratesAreGalerkin) {
  // From zero, xᵀ(Hx − b) = 0 for every iterate: the decrease that damped methods predict holds for inexact steps too.
  std::mt19937 random(6);
  const BlockMatrix matrix = randomSystem(Shape::random, 300, {3, 6}, random);
  const Eigen::MatrixXd dense = toDense(matrix);
  const Eigen::VectorXd b = randomVector(dense.rows(), random);
  const auto solver = makePcgSolver({.tolerance = 0.3});
  solver->analyze(patternOf(matrix), 1);
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  Eigen::VectorXd x = b;
  ASSERT_TRUE(solver->solve(spanOf(x)).ok());
  EXPECT_GT((dense * x - b).norm(), 1e-3 * b.norm());
  EXPECT_NEAR(x.dot(dense * x - b), 0.0, 1e-12 * x.norm() * b.norm());
}

TEST(Pcg, TheSameBitsForAnyNumberOfThreads) {
  std::mt19937 random(7);
  const BlockMatrix matrix = randomSystem(Shape::grid, 3000, {3, 6}, random);  // several chunks
  const Eigen::VectorXd b = randomVector(matrix.layout().scalars(), random);
  std::vector<Eigen::VectorXd> solutions;
  for (const int threads : {1, 2, 7}) {
    const auto solver = makePcgSolver({.tolerance = 1e-10});
    solver->analyze(patternOf(matrix), threads);
    ASSERT_TRUE(solver->factorize(matrix, {}).ok());
    solutions.push_back(b);
    ASSERT_TRUE(solver->solve(spanOf(solutions.back())).ok());
  }
  EXPECT_EQ(solutions[0], solutions[1]);
  EXPECT_EQ(solutions[0], solutions[2]);
}

TEST(Pcg, OneBlockIsSolvedAtOnce) {
  std::mt19937 random(8);
  const BlockMatrix matrix = randomSystem(Shape::disconnected, 1, {9}, random);
  const auto solver = makePcgSolver();
  solver->analyze(patternOf(matrix), 1);
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  Eigen::VectorXd x = randomVector(9, random);
  ASSERT_TRUE(solver->solve(spanOf(x)).ok());
  EXPECT_EQ(solver->statistics().iterations, 1) << "block Jacobi is exact";
}

TEST(Pcg, SaysWhenItDoesNotConverge) {
  std::mt19937 random(9);
  const BlockMatrix matrix = randomSystem(Shape::grid, 400, {6}, random);
  const auto solver = makePcgSolver({.tolerance = 1e-12, .maxIterations = 3});
  solver->analyze(patternOf(matrix), 1);
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  Eigen::VectorXd x = randomVector(matrix.layout().scalars(), random);
  EXPECT_EQ(solver->solve(spanOf(x)).outcome, SolverStatus::Outcome::notConverged);
  EXPECT_EQ(solver->statistics().iterations, 3);
}

TEST(Pcg, NoticesAnIndefiniteMatrixWithDefiniteBlocks) {
  BlockMatrix matrix(std::make_shared<const BlockPattern>(
      BlockPattern::fromPairs(BlockLayout({1, 1}), std::vector<std::pair<int, int>>{{1, 0}})));
  *matrix.block(matrix.pattern().find(0, 0)) = 1.0;
  *matrix.block(matrix.pattern().find(1, 1)) = 1.0;
  *matrix.block(matrix.pattern().find(1, 0)) = -3.0;
  const auto solver = makePcgSolver();
  solver->analyze(patternOf(matrix), 1);
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  Eigen::VectorXd x = Eigen::Vector2d(1.0, 1.0);
  EXPECT_EQ(solver->solve(spanOf(x)).outcome, SolverStatus::Outcome::notPositiveDefinite);
}

TEST(Pcg, ForcingTightensAsRightHandSidesFall) {
  std::mt19937 random(10);
  const BlockMatrix matrix = randomSystem(Shape::grid, 400, {6}, random);
  const auto solver = makePcgSolver({.tolerance = 1e-10, .maxIterations = 0, .forcing = true});
  solver->analyze(patternOf(matrix), 1);
  const Eigen::VectorXd b = randomVector(matrix.layout().scalars(), random);
  std::vector<int> iterations;
  for (const double size : {1.0, 1e-1, 1e-4, 1e3}) {
    ASSERT_TRUE(solver->factorize(matrix, {}).ok());
    Eigen::VectorXd x = size * b;
    ASSERT_TRUE(solver->solve(spanOf(x)).ok());
    iterations.push_back(solver->statistics().iterations);
  }
  EXPECT_LT(iterations[0], iterations[1]);
  EXPECT_LT(iterations[1], iterations[2]);
  EXPECT_GE(iterations[3], iterations[2]) << "it never loosens within a descent";
  solver->restart();
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  Eigen::VectorXd x = b;
  ASSERT_TRUE(solver->solve(spanOf(x)).ok());
  EXPECT_EQ(solver->statistics().iterations, iterations[0]) << "another descent begins anew";
  x = 1e-9 * b;
  ASSERT_TRUE(solver->solve(spanOf(x)).ok());
  EXPECT_GT(solver->statistics().iterations, iterations[2]) << "beside the step of a factorisation, solves are exact";
}

}  // namespace
}  // namespace quiver::test
