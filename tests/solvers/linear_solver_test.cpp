#include <quiver/solvers/backends/linear_solver.h>

#include <gtest/gtest.h>

#include <functional>

#include <quiver/core/util/error.h>
#include <quiver/solvers/backends/block_solver.h>
#include <quiver/solvers/backends/dense_solver.h>
#include <quiver/solvers/backends/eigen_solver.h>
#include <quiver/solvers/backends/pcg_solver.h>
#ifdef QUIVER_TEST_CHOLMOD
#  include <quiver/solvers/backends/cholmod/cholmod_solver.h>
#endif
#include <quiver/solvers/cholesky/block_cholesky.h>
#include <quiver/solvers/cholesky/kernels/kernel_table.h>
#include <tests/solvers/random_system.h>

namespace quiver::test {
namespace {

struct Backend {
  std::string name;
  std::function<std::unique_ptr<LinearSolver>()> make;
};

std::ostream& operator<<(std::ostream& out, const Backend& backend) { return out << backend.name; }

class LinearSolverTest : public ::testing::TestWithParam<Backend> {
 protected:
  /// The matrix in the order the solver wants.
  BlockMatrix ordered(const LinearSolver& solver, Shape shape, int blocks, const std::vector<int>& choices) {
    const BlockLayout layout(randomDimensions(blocks, choices, random_));
    const BlockPattern natural = BlockPattern::fromPairs(layout, randomPairs(shape, blocks, random_));
    BlockMatrix matrix(std::make_shared<const BlockPattern>(natural.permuted(solver.order(natural).order)));
    fillDominant(matrix, random_);
    return matrix;
  }

  std::mt19937 random_{7};
};

/// ‖Hx − b‖ ≤ 1e-13 (‖H‖‖x‖ + ‖b‖), and 1e-8 relative to the reference: the contract of every backend.
void expectSolution(const Eigen::MatrixXd& dense, const Eigen::MatrixXd& b, const Eigen::MatrixXd& x,
                    const std::string& what) {
  EXPECT_LE((dense * x - b).norm(), 1e-13 * (dense.norm() * x.norm() + b.norm())) << what;
  const Eigen::MatrixXd reference = dense.ldlt().solve(b);
  EXPECT_LE((x - reference).norm(), 1e-8 * reference.norm()) << what;
}

std::span<double> spanOf(Eigen::MatrixXd& matrix) { return {matrix.data(), static_cast<std::size_t>(matrix.size())}; }

const std::vector<std::vector<int>> dimensionChoices{{1}, {2}, {3}, {6},  {7},    {9},
                                                     {4}, {5}, {8}, {11}, {3, 6}, {1, 2, 3, 6, 7, 9}};

TEST_P(LinearSolverTest, solvesRandomSystems) {
  for (const auto& choices : dimensionChoices) {
    for (const Shape shape :
         {Shape::random, Shape::chain, Shape::grid, Shape::arrow, Shape::disconnected, Shape::full}) {
      for (const int blocks : {1, 2, 3, 5, 8, 13, 27, 60}) {
        const auto solver = GetParam().make();
        const BlockMatrix matrix = ordered(*solver, shape, blocks, choices);
        const Eigen::MatrixXd dense = toDense(matrix);
        const Eigen::MatrixXd b = randomVector(dense.rows(), random_);
        solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 1);
        ASSERT_TRUE(solver->factorize(matrix, {}).ok());
        Eigen::MatrixXd x = b;
        ASSERT_TRUE(solver->solve(spanOf(x)).ok());
        expectSolution(dense, b, x, std::string(toString(shape)) + ' ' + std::to_string(blocks));
      }
    }
  }
}

TEST_P(LinearSolverTest, solvesLargerSystems) {
  for (const auto& choices : std::vector<std::vector<int>>{{3}, {6}, {2, 3, 6}}) {
    for (const Shape shape : {Shape::random, Shape::grid}) {
      const auto solver = GetParam().make();
      const BlockMatrix matrix = ordered(*solver, shape, 250, choices);
      const Eigen::MatrixXd dense = toDense(matrix);
      const Eigen::MatrixXd b = randomVector(dense.rows(), random_);
      solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 2);
      ASSERT_TRUE(solver->factorize(matrix, {}).ok());
      Eigen::MatrixXd x = b;
      ASSERT_TRUE(solver->solve(spanOf(x)).ok());
      expectSolution(dense, b, x, toString(shape));
    }
  }
}

TEST_P(LinearSolverTest, factorsAndSolvesAtOnceWithTheSameBits) {
  for (const auto& choices : std::vector<std::vector<int>>{{3}, {6}, {2, 3, 6}}) {
    for (const int threads : {1, 2}) {
      const auto solver = GetParam().make();
      const BlockMatrix matrix = ordered(*solver, Shape::grid, 400, choices);
      const std::int64_t scalars = matrix.layout().scalars();
      const Eigen::VectorXd b = randomVector(scalars, random_);
      Eigen::MatrixXd damping = randomVector(scalars, random_).cwiseAbs();
      solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), threads);
      Eigen::MatrixXd separate = b, together = b;
      ASSERT_TRUE(solver->factorize(matrix, spanOf(damping)).ok());
      ASSERT_TRUE(solver->solve(spanOf(separate)).ok());
      ASSERT_TRUE(solver->factorizeAndSolve(matrix, spanOf(damping), spanOf(together)).ok());
      EXPECT_EQ(together, separate) << threads << " threads";
      Eigen::MatrixXd again = b;
      ASSERT_TRUE(solver->solve(spanOf(again)).ok());
      EXPECT_EQ(again, separate) << "the factor serves on";
    }
  }
}

TEST_P(LinearSolverTest, solvesInAnyOrderItIsGiven) {
  const auto solver = GetParam().make();
  for (const int blocks : {5, 40}) {
    const BlockMatrix matrix = randomSystem(Shape::random, blocks, {1, 3, 6}, random_);
    const Eigen::MatrixXd dense = toDense(matrix);
    const Eigen::MatrixXd b = randomVector(dense.rows(), random_);
    solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 1);
    ASSERT_TRUE(solver->factorize(matrix, {}).ok());
    Eigen::MatrixXd x = b;
    solver->solve(spanOf(x));
    expectSolution(dense, b, x, "natural order");
  }
}

TEST_P(LinearSolverTest, factorsTheSameStructureAgainAndAddsDamping) {
  const auto solver = GetParam().make();
  BlockMatrix matrix = ordered(*solver, Shape::grid, 49, {2, 3, 6});
  solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 1);
  for (int round = 0; round < 3; ++round) {
    fillDominant(matrix, random_);
    const std::vector<double> before(matrix.values().begin(), matrix.values().end());
    Eigen::MatrixXd dense = toDense(matrix);
    const Eigen::VectorXd damping = randomVector(dense.rows(), random_).cwiseAbs() * 10.0;
    dense.diagonal() += damping;
    const Eigen::MatrixXd b = randomVector(dense.rows(), random_);
    ASSERT_TRUE(solver->factorize(matrix, {damping.data(), static_cast<std::size_t>(damping.size())}).ok());
    EXPECT_TRUE(std::ranges::equal(matrix.values(), before)) << "the matrix must not change";
    Eigen::MatrixXd x = b;
    solver->solve(spanOf(x));
    expectSolution(dense, b, x, "damped");
  }
}

TEST_P(LinearSolverTest, solvesSeveralRightHandSides) {
  const auto solver = GetParam().make();
  const BlockMatrix matrix = ordered(*solver, Shape::random, 45, {3, 6});
  const Eigen::MatrixXd dense = toDense(matrix);
  solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 2);
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  for (const int count : {0, 1, 2, 3, 8, 13}) {
    Eigen::MatrixXd b(dense.rows(), count);
    for (int c = 0; c < count; ++c) b.col(c) = randomVector(dense.rows(), random_);
    Eigen::MatrixXd x = b;
    ASSERT_TRUE(solver->solve(spanOf(x), count).ok());
    if (count > 0) expectSolution(dense, b, x, std::to_string(count));
  }
}

TEST_P(LinearSolverTest, namesTheBlockOfAFailedPivot) {
  for (const int blocks : {6, 50, 120}) {
    const auto solver = GetParam().make();
    BlockMatrix matrix = ordered(*solver, Shape::grid, blocks, {3, 6});
    const BlockLayout& layout = matrix.layout();
    solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 2);
    // An empty row and column: its pivot is exactly zero whatever was eliminated before.
    const int bad = blocks / 2;
    const int coordinate = 1;
    for (int column = 0; column <= bad; ++column) {
      const std::int64_t k = matrix.pattern().find(bad, column);
      if (k < 0) continue;
      const int rows = layout.dimension(bad);
      for (int c = 0; c < layout.dimension(column); ++c) matrix.block(k)[c * rows + coordinate] = 0.0;
    }
    for (std::int64_t k = matrix.pattern().columnBegin(bad); k < matrix.pattern().columnEnd(bad); ++k) {
      const int rows = layout.dimension(matrix.pattern().row(k));
      std::fill_n(matrix.block(k) + coordinate * rows, rows, 0.0);
    }
    const SolverStatus status = solver->factorize(matrix, {});
    EXPECT_EQ(status.outcome, SolverStatus::Outcome::notPositiveDefinite);
    EXPECT_EQ(status.block, bad);
    EXPECT_EQ(status.coordinate, coordinate);
    EXPECT_TRUE(std::isnan(status.pivot) || status.pivot == 0.0) << status.pivot;
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(layout.scalars(), 1);
    EXPECT_THROW(solver->solve(spanOf(x)), LogicError);
    const std::vector<double> damping(static_cast<std::size_t>(layout.scalars()), 1.0);
    EXPECT_TRUE(solver->factorize(matrix, damping).ok()) << "damping repairs it";
  }
}

TEST_P(LinearSolverTest, refusesMisuse) {
  const auto solver = GetParam().make();
  const BlockMatrix matrix = randomSystem(Shape::chain, 9, {3}, random_);
  const BlockMatrix other = randomSystem(Shape::chain, 10, {3}, random_);
  EXPECT_THROW(solver->factorize(matrix, {}), LogicError);
  solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 1);
  EXPECT_THROW(solver->factorize(other, {}), LogicError);
  EXPECT_THROW(solver->factorize(matrix, std::vector<double>(5, 1.0)), LogicError);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(27, 1);
  EXPECT_THROW(solver->solve(spanOf(x)), LogicError);
  ASSERT_TRUE(solver->factorize(matrix, {}).ok());
  EXPECT_THROW(solver->solve(spanOf(x), 2), LogicError);
}

TEST_P(LinearSolverTest, stopsWhenAsked) {
  const auto solver = GetParam().make();
  const BlockMatrix matrix = ordered(*solver, Shape::grid, 100, {6});
  solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 2);
  std::stop_source source;
  source.request_stop();
  const SolverStatus status = solver->factorize(matrix, {}, StopCondition(1e10, source.get_token()));
  EXPECT_EQ(status.outcome, SolverStatus::Outcome::interrupted);
  EXPECT_TRUE(solver->factorize(matrix, {}).ok());
}

TEST_P(LinearSolverTest, reportsTheSizeOfTheFactor) {
  if (GetParam().name == "pcg") GTEST_SKIP() << "factors diagonal blocks alone";
  const auto solver = GetParam().make();
  const BlockMatrix matrix = randomSystem(Shape::full, 9, {3}, random_);
  solver->analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 1);
  EXPECT_EQ(solver->statistics().nonzeros, 27 * 28 / 2);
  EXPECT_EQ(solver->statistics().flops, 27.0 * 28.0 * 55.0 / 6.0);
  EXPECT_GT(solver->statistics().bytes, 0);
}

std::vector<Backend> allBackends() {
  std::vector<Backend> backends{{"block", makeBlockSolver}, {"dense", makeDenseSolver}, {"eigen", makeEigenSolver}};
  // As exact as the contract of the direct ones asks.
  backends.push_back({"pcg", [] { return makePcgSolver({.tolerance = 1e-16}); }});
#ifdef QUIVER_TEST_CHOLMOD
  backends.push_back({"cholmod", makeCholmodSolver});
#endif
  for (const detail::KernelLevel level : detail::availableKernelLevels()) {
    backends.push_back({std::string("block_") + detail::kernelTable(level).name,
                        [level] { return std::make_unique<detail::BlockCholesky>(level); }});
  }
  return backends;
}

INSTANTIATE_TEST_SUITE_P(Backends, LinearSolverTest, ::testing::ValuesIn(allBackends()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace quiver::test
