#include <quiver/solvers/cholesky/block_cholesky.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <numeric>

#ifdef __GLIBC__
#  include <malloc.h>
#endif

#include <quiver/core/util/error.h>
#include <quiver/solvers/cholesky/arena_planner.h>
#include <quiver/solvers/cholesky/kernels/kernel_table.h>
#include <tests/allocation_counter.h>
#include <tests/solvers/large_system.h>

namespace quiver::test {
namespace {

using detail::BlockCholesky;
using detail::FactorPlan;

/// A grid with long-range edges: large enough for fronts, leaves and several tasks.
const std::vector<std::vector<int>> largeChoices{{2}, {3}, {6}, {9}, {3, 6}, {1, 2, 7}};

TEST(BlockCholesky, givesTheSameBitsForAnyNumberOfThreads) {
  std::mt19937 random(11);
  for (const auto& choices : largeChoices) {
    const BlockMatrix matrix = largeSystem(choices, random);
    const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
    const auto scalars = static_cast<Eigen::Index>(pattern->layout().scalars());
    const Eigen::VectorXd b = randomVector(2 * scalars, random);
    Eigen::VectorXd reference;
    for (const int threads : {1, 2, 3, 2}) {
      BlockCholesky solver;
      solver.analyze(pattern, threads);
      ASSERT_TRUE(solver.factorize(matrix, {}).ok());
      Eigen::VectorXd x = b;
      solver.solve({x.data(), static_cast<std::size_t>(x.size())}, 2);
      if (threads == 1) reference = x;
      EXPECT_EQ(std::memcmp(x.data(), reference.data(), sizeof(double) * static_cast<std::size_t>(x.size())), 0)
          << threads;
      EXPECT_TRUE(threads == 1 || choices.front() <= 3 || solver.plan().schedule.tasks.size() > 1u);
    }
  }
}

TEST(BlockCholesky, solvesLargeSystems) {
  std::mt19937 random(12);
  for (const auto& choices : largeChoices) {
    const BlockMatrix matrix = largeSystem(choices, random);
    const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
    for (const detail::KernelLevel level : detail::availableKernelLevels()) {
      BlockCholesky solver(level);
      solver.analyze(pattern, 2);
      ASSERT_TRUE(solver.factorize(matrix, {}).ok());
      const Eigen::VectorXd b = randomVector(pattern->layout().scalars(), random);
      Eigen::VectorXd x = b;
      solver.solve({x.data(), static_cast<std::size_t>(x.size())});
      Eigen::VectorXd product(x.size());
      matrix.multiply({x.data(), static_cast<std::size_t>(x.size())},
                      {product.data(), static_cast<std::size_t>(x.size())});
      const double norm =
          Eigen::Map<const Eigen::VectorXd>(matrix.values().data(), static_cast<Eigen::Index>(matrix.values().size()))
              .norm();
      EXPECT_LE((product - b).norm(), 1e-13 * (norm * x.norm() + b.norm())) << detail::kernelTable(level).name;
    }
  }
}

TEST(BlockCholesky, solvesRightHandSidesTogetherAsOneByOne) {
  std::mt19937 random(14);
  for (const auto& choices : largeChoices) {
    const BlockMatrix matrix = largeSystem(choices, random);
    const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
    const auto scalars = static_cast<std::size_t>(pattern->layout().scalars());
    constexpr int count = 7;
    std::vector<double> together(count * scalars);
    for (double& value : together) value = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    std::vector<double> single = together;
    BlockCholesky solver;
    solver.analyze(pattern, 2);
    ASSERT_TRUE(solver.factorize(matrix, {}).ok());
    solver.solve(together, count);
    for (int k = 0; k < count; ++k)
      solver.solve(std::span(single).subspan(static_cast<std::size_t>(k) * scalars, scalars));
    EXPECT_EQ(together, single);
  }
}

TEST(BlockCholesky, analyzesOtherStructuresAnew) {
  std::mt19937 random(15);
  BlockCholesky solver;
  for (const auto& choices : largeChoices) {
    const BlockMatrix matrix = largeSystem(choices, random, 300);
    const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
    solver.analyze(pattern, 2);
    std::vector<double> x(static_cast<std::size_t>(pattern->layout().scalars()), 1.0);
    EXPECT_THROW(solver.solve(x), LogicError);  // not before the new matrix is factored
    ASSERT_TRUE(solver.factorize(matrix, {}).ok());
    solver.solve(x);
    std::vector<double> product(x.size());
    matrix.multiply(x, product);
    for (const double value : product) EXPECT_NEAR(value, 1.0, 1e-12);
  }
}

TEST(BlockCholesky, doesNotAllocateAfterTheAnalysis) {
  std::mt19937 random(13);
  for (const auto& choices : largeChoices) {
    const BlockMatrix matrix = largeSystem(choices, random);
    const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
    std::vector<double> x(static_cast<std::size_t>(6 * pattern->layout().scalars()), 1.0);
    const std::vector<double> damping(static_cast<std::size_t>(pattern->layout().scalars()), 0.5);
    BlockCholesky solver;
    solver.analyze(pattern, 1);
    const auto again = std::make_shared<const BlockPattern>(matrix.pattern());
    allocations = 0;
    countAllocations = true;
    solver.analyze(again, 1);  // the same structure: nothing to do
    const bool solved = solver.factorize(matrix, damping).ok() && solver.solve(x, 6).ok();
    countAllocations = false;
    EXPECT_TRUE(solved);
    EXPECT_EQ(allocations, 0);
  }
}

TEST(BlockCholesky, namesTheFirstFailedPivotWhateverTheThreads) {
  std::mt19937 random(14);
  BlockMatrix matrix = largeSystem({6}, random);
  const BlockPattern& pattern = matrix.pattern();
  // Several blocks that fail: far apart, so in different tasks.
  for (const int bad : {100, 450, 800}) matrix.block(pattern.columnBegin(bad))[0] = -1.0;
  SolverStatus first;
  for (const int threads : {1, 2, 3}) {
    BlockCholesky solver;
    solver.analyze(std::make_shared<const BlockPattern>(pattern), threads);
    const SolverStatus status = solver.factorize(matrix, {});
    ASSERT_EQ(status.outcome, SolverStatus::Outcome::notPositiveDefinite);
    EXPECT_LT(status.pivot, 0.0);
    if (threads == 1) first = status;
    EXPECT_EQ(status.block, first.block);
    EXPECT_EQ(status.coordinate, first.coordinate);
    EXPECT_EQ(status.pivot, first.pivot);
  }
  EXPECT_EQ(first.coordinate, 0);
}

TEST(BlockCholesky, solvesTheEmptySystem) {
  const BlockMatrix matrix(std::make_shared<const BlockPattern>(BlockPattern::fromPairs(BlockLayout(), {})));
  BlockCholesky solver;
  solver.analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 2);
  EXPECT_TRUE(solver.factorize(matrix, {}).ok());
  EXPECT_TRUE(solver.solve({}).ok());
  EXPECT_EQ(solver.statistics().nonzeros, 0);
}

TEST(BlockCholesky, refusesNumbersThatAreNone) {
  std::mt19937 random(15);
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    BlockMatrix matrix = randomSystem(Shape::grid, 64, {3}, random);
    matrix.block(matrix.pattern().columnBegin(20))[0] = value;
    BlockCholesky solver;
    solver.analyze(std::make_shared<const BlockPattern>(matrix.pattern()), 1);
    EXPECT_EQ(solver.factorize(matrix, {}).outcome, SolverStatus::Outcome::notPositiveDefinite);
  }
}

TEST(FactorPlan, keepsAncestorsAfterDescendantsAndTasksApart) {
  std::mt19937 random(16);
  for (const auto& choices : largeChoices) {
    const BlockMatrix matrix = largeSystem(choices, random);
    for (const int threads : {1, 2, 4}) {
      const FactorPlan plan(matrix.pattern(), threads);
      const int count = static_cast<int>(plan.nodes.size());
      std::vector<int> place(plan.blocks.size());
      for (std::size_t i = 0; i < place.size(); ++i)
        place[static_cast<std::size_t>(plan.blocks[i])] = static_cast<int>(i);
      const BlockPattern& pattern = matrix.pattern();
      for (int j = 0; j < pattern.blocks(); ++j) {
        for (std::int64_t k = pattern.columnBegin(j) + 1; k < pattern.columnEnd(j); ++k) {
          EXPECT_GT(place[static_cast<std::size_t>(pattern.row(k))], place[static_cast<std::size_t>(j)]);
        }
      }
      std::vector<int> seen(plan.nodes.size(), 0);
      for (const auto& task : plan.schedule.tasks) {
        for (int node = task.begin; node < task.end; ++node) ++seen[static_cast<std::size_t>(node)];
      }
      for (const int node : plan.schedule.top) ++seen[static_cast<std::size_t>(node)];
      for (int node = 0; node < count; ++node) {
        EXPECT_EQ(seen[static_cast<std::size_t>(node)], 1);
        const int parent = plan.nodes[static_cast<std::size_t>(node)].parent;
        EXPECT_TRUE(parent < 0 || parent > node);
        int rows = 0;
        for (const auto& run : plan.runsOf(node)) {
          EXPECT_EQ(run.source, rows);
          rows += run.length;
        }
        EXPECT_EQ(rows, plan.nodes[static_cast<std::size_t>(node)].rows);
      }
    }
  }
}

TEST(BlockCholesky, forgetsTheFactorBefore) {
  std::mt19937 random(22);
  for (const auto& choices : largeChoices) {
    BlockMatrix matrix = largeSystem(choices, random);
    const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
    const auto solved = [&](BlockCholesky& solver) {
      EXPECT_TRUE(solver.factorize(matrix, {}).ok());
      std::vector<double> x(static_cast<std::size_t>(pattern->layout().scalars()), 1.0);
      solver.solve(x);
      return x;
    };
    BlockCholesky used;
    used.analyze(pattern, 2);
    solved(used);
    fillDominant(matrix, random);
    BlockCholesky fresh;
    fresh.analyze(pattern, 2);
    EXPECT_EQ(solved(used), solved(fresh));
  }
}

/// While it lives, memory comes filled with what is not a number, where the C library can do that.
class SoiledMemory {
 public:
  SoiledMemory() { set(0x100); }  // the complement of its last byte
  ~SoiledMemory() { set(0); }
  SoiledMemory(const SoiledMemory&) = delete;
  SoiledMemory& operator=(const SoiledMemory&) = delete;

 private:
  static void set([[maybe_unused]] int value) {
#ifdef __GLIBC__
    mallopt(M_PERTURB, value);
#endif
  }
};

/// Memory is not cleared before it is used, and vectors reach behind what counts.
TEST(BlockCholesky, DoesNotDependOnWhatMemoryHeld) {
  std::mt19937 random(24);
  for (int round = 0; round < 8; ++round) {
    for (const int b : {1, 2, 3, 4, 5, 6, 7, 8, 9}) {
      const int blocks = 100 + static_cast<int>(random() % 300);
      const BlockMatrix matrix = largeSystem({b}, random, blocks);
      const auto pattern = std::make_shared<const BlockPattern>(matrix.pattern());
      for (const detail::KernelLevel level : detail::availableKernelLevels()) {
        const SoiledMemory soiled;
        BlockCholesky solver(level);
        solver.analyze(pattern, 1);
        ASSERT_TRUE(solver.factorize(matrix, {}).ok());
        std::vector<double> x(static_cast<std::size_t>(pattern->layout().scalars()), 1.0);
        solver.solve(x);
        ASSERT_TRUE(std::ranges::all_of(x, [](double v) { return std::isfinite(v); })) << b << " " << blocks;
      }
    }
  }
}

TEST(ArenaPlanner, neverHandsOutAPlaceTwice) {
  std::mt19937 random(17);
  detail::ArenaPlanner planner;
  std::vector<std::pair<std::int64_t, std::int64_t>> live;
  for (int step = 0; step < 2000; ++step) {
    if (live.empty() || random() % 5 < 3) {
      const std::int64_t size = 1 + random() % 100;
      const std::int64_t offset = planner.allocate(size);
      for (const auto& [other, length] : live) EXPECT_TRUE(offset + size <= other || other + length <= offset);
      EXPECT_LE(offset + size, planner.peak());
      live.emplace_back(offset, size);
    } else {
      const std::size_t k = random() % live.size();
      planner.release(live[k].first, live[k].second);
      live[k] = live.back();
      live.pop_back();
    }
  }
  for (const auto& [offset, size] : live) planner.release(offset, size);
  EXPECT_EQ(planner.allocate(planner.peak()), 0) << "all places grow together again";
}

/// A front factored by the kernels against Eigen, for every instruction set of this machine.
TEST(Kernels, factorAFrontLikeADenseMatrix) {
  std::mt19937 random(18);
  for (const detail::KernelLevel level : detail::availableKernelLevels()) {
    const detail::KernelTable& kernels = detail::kernelTable(level);
    for (const int columns : {1, 2, 5, 6, 7, 12, 31, 47, 48, 49, 96, 115}) {
      for (const int below : {0, 1, 3, 8, 29, 64, 131}) {
        const int padded = (columns + 7) / 8 * 8;
        const int rows = padded + (below + 7) / 8 * 8;
        const int n = columns + below;
        Eigen::MatrixXd dense =
            Eigen::MatrixXd::NullaryExpr(n, n, [&] { return std::uniform_real_distribution<double>(-1, 1)(random); });
        dense = (dense * dense.transpose()).eval();
        dense.diagonal().array() += 1.0;
        Eigen::MatrixXd panel = Eigen::MatrixXd::Zero(rows, columns);
        panel.topRows(columns) = dense.topLeftCorner(columns, columns).triangularView<Eigen::Lower>();
        if (below > 0) panel.middleRows(padded, below) = dense.bottomLeftCorner(below, columns);
        Eigen::VectorXd inverse(columns);
        double pivot = 0.0;
        const double next[100] = {};
        detail::UpcomingMemory upcoming{next, next + 100};
        for (int begin = 0; begin < columns; begin += detail::chunkColumns) {
          const int width = std::min(detail::chunkColumns, columns - begin);
          ASSERT_EQ(kernels.factorDiagonal(panel.data(), rows, begin, width, inverse.data(), &pivot), -1);
          const int first = begin + (width + 7) / 8 * 8;
          kernels.solveRows(panel.data(), rows, begin, width, first, rows, inverse.data());
          if (begin + width < columns) {
            kernels.updatePanel(panel.data(), rows, begin, width, begin + width, columns, first, rows, &upcoming);
          }
        }
        const Eigen::MatrixXd factor = dense.llt().matrixL();
        const Eigen::MatrixXd top = panel.topRows(columns).triangularView<Eigen::Lower>();
        EXPECT_LE((top - factor.topLeftCorner(columns, columns)).norm(), 1e-12 * factor.norm());
        EXPECT_LE((inverse.cwiseProduct(factor.diagonal().head(columns)).array() - 1.0).abs().maxCoeff(), 1e-12);
        if (below == 0) continue;
        EXPECT_LE((panel.middleRows(padded, below) - factor.bottomLeftCorner(below, columns)).norm(),
                  1e-12 * factor.norm());
        Eigen::MatrixXd update(rows - padded, below);
        for (int c = 0; c < below; c += 48) {
          kernels.formUpdate(update.data() + c * (rows - padded + 1), rows - padded, panel.data() + padded + c, rows,
                             columns, std::min(48, below - c), rows - padded - c, &upcoming);
        }
        const Eigen::MatrixXd b = factor.bottomLeftCorner(below, columns);
        const Eigen::MatrixXd expected = (-b * b.transpose()).triangularView<Eigen::Lower>();
        const Eigen::MatrixXd lower = update.topRows(below).triangularView<Eigen::Lower>();
        EXPECT_LE((lower - expected).norm(), 1e-12 * (expected.norm() + 1.0));
      }
    }
  }
}

TEST(Kernels, levelsAreOrderedAndKnown) {
  const auto levels = detail::availableKernelLevels();
  ASSERT_FALSE(levels.empty());
  EXPECT_EQ(levels.front(), detail::KernelLevel::generic);
  EXPECT_STREQ(detail::kernelTable(detail::KernelLevel::automatic).name, detail::kernelTable(levels.back()).name);
}

}  // namespace
}  // namespace quiver::test
