#include <quiver/solvers/block/ordering.h>

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <numeric>
#include <thread>

#include <quiver/solvers/block/factor_pattern.h>
#include <tests/solvers/random_system.h>

namespace quiver::test {
namespace {

/// Fills the blocks of L by eliminating one block after the other on a dense boolean matrix.
std::vector<std::vector<bool>> eliminateNaively(const BlockPattern& pattern, const std::vector<int>& order) {
  const BlockPattern permuted = pattern.permuted(order);
  const int count = permuted.blocks();
  std::vector<std::vector<bool>> filled(static_cast<std::size_t>(count),
                                        std::vector<bool>(static_cast<std::size_t>(count)));
  const auto at = [&](int i, int j) { return filled[static_cast<std::size_t>(i)].begin() + j; };
  for (int j = 0; j < count; ++j) {
    for (std::int64_t k = permuted.columnBegin(j); k < permuted.columnEnd(j); ++k) *at(permuted.row(k), j) = true;
  }
  for (int j = 0; j < count; ++j) {
    for (int a = j + 1; a < count; ++a) {
      for (int b = j + 1; b <= a; ++b) {
        if (*at(a, j) && *at(b, j)) *at(a, b) = true;
      }
    }
  }
  return filled;
}

bool isPermutation(std::vector<int> order) {
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i] != static_cast<int>(i)) return false;
  }
  return true;
}

BlockPattern randomPattern(Shape shape, int blocks, std::mt19937& random) {
  return BlockPattern::fromPairs(BlockLayout(randomDimensions(blocks, {1, 2, 3, 6}, random)),
                                 randomPairs(shape, blocks, random));
}

const std::vector<Shape> allShapes{Shape::random, Shape::chain,        Shape::grid,
                                   Shape::arrow,  Shape::disconnected, Shape::full};

TEST(Ordering, everyMethodGivesAPostorderedPermutation) {
  std::mt19937 random(4);
  for (const Shape shape : allShapes) {
    for (const int blocks : {0, 1, 2, 3, 9, 60}) {
      const BlockPattern pattern = randomPattern(shape, blocks, random);
      std::vector<BlockOrdering> orderings{amdOrdering(pattern), chooseOrdering(pattern), naturalOrdering(blocks)};
      if (hasMetis()) orderings.push_back(metisOrdering(pattern));
      for (const BlockOrdering& ordering : orderings) {
        ASSERT_EQ(static_cast<int>(ordering.order.size()), blocks);
        EXPECT_TRUE(isPermutation(ordering.order)) << ordering.name << ' ' << toString(shape);
        if (ordering.name == "natural") continue;
        const EliminationTree tree(BlockGraph(pattern), ordering.order);
        const std::vector<int> post = postorder(tree.parent);
        EXPECT_TRUE(std::is_sorted(post.begin(), post.end())) << ordering.name << ' ' << toString(shape);
      }
    }
  }
}

TEST(Ordering, isTheSameEveryTime) {
  std::mt19937 random(5);
  const BlockPattern pattern = randomPattern(Shape::random, 300, random);
  EXPECT_EQ(amdOrdering(pattern).order, amdOrdering(pattern).order);
  if (hasMetis()) {
    EXPECT_EQ(metisOrdering(pattern).order, metisOrdering(pattern).order);
  }
}

TEST(Ordering, minimumDegreeBeatsTheNaturalOrderOnAnArrow) {
  // Block 0 is joined to all others: eliminated first it fills everything, eliminated last nothing.
  std::vector<std::pair<int, int>> pairs;
  for (int i = 1; i < 50; ++i) pairs.emplace_back(i, 0);
  const BlockPattern pattern = BlockPattern::fromPairs(BlockLayout(std::vector<int>(50, 3)), pairs);
  const FactorSize natural = predictFactor(pattern, naturalOrdering(50).order);
  const FactorSize chosen = predictFactor(pattern, chooseOrdering(pattern).order);
  EXPECT_EQ(natural.nonzeros, 150 * 151 / 2);
  EXPECT_EQ(chosen.nonzeros, 50 * 6 + 49 * 9);
  EXPECT_LT(chosen.flops, natural.flops);
}

TEST(Ordering, triesDissectionOnALargeGrid) {
  if (!hasMetis()) GTEST_SKIP() << "built without METIS";
  const int width = 14;  // a cube: minimum degree fills much more than dissection
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < width * width * width; ++i) {
    if (i % width != 0) pairs.emplace_back(i, i - 1);
    if (i / width % width != 0) pairs.emplace_back(i, i - width);
    if (i >= width * width) pairs.emplace_back(i, i - width * width);
  }
  const BlockPattern pattern =
      BlockPattern::fromPairs(BlockLayout(std::vector<int>(static_cast<std::size_t>(width * width * width), 6)), pairs);
  EXPECT_EQ(chooseOrdering(pattern).name, "metis");
}

TEST(EliminationTree, structureAndSizesEqualDenseElimination) {
  std::mt19937 random(6);
  for (const Shape shape : allShapes) {
    for (const int blocks : {1, 2, 7, 30}) {
      const BlockPattern pattern = randomPattern(shape, blocks, random);
      std::vector<int> order(static_cast<std::size_t>(blocks));
      std::iota(order.begin(), order.end(), 0);
      std::vector<std::vector<int>> orders{order, amdOrdering(pattern).order};
      std::shuffle(order.begin(), order.end(), random);
      orders.push_back(order);
      for (const std::vector<int>& order : orders) {
        const auto filled = eliminateNaively(pattern, order);
        const BlockGraph graph(pattern);
        const EliminationTree tree(graph, order);
        const FactorPattern factor(graph, order, tree);
        FactorSize expected;
        for (int j = 0; j < blocks; ++j) {
          std::vector<int> rows;
          std::int64_t below = 0;
          for (int i = j + 1; i < blocks; ++i) {
            if (!filled[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]) continue;
            rows.push_back(i);
            below += pattern.layout().dimension(order[static_cast<std::size_t>(i)]);
          }
          EXPECT_TRUE(std::ranges::equal(factor.column(j), rows));
          EXPECT_EQ(tree.parent[static_cast<std::size_t>(j)], rows.empty() ? -1 : rows.front());
          for (int c = 1; c <= pattern.layout().dimension(order[static_cast<std::size_t>(j)]); ++c) {
            expected.nonzeros += below + c;
            expected.flops += static_cast<double>((below + c) * (below + c));
          }
        }
        const FactorSize size = predictFactor(pattern, order);
        EXPECT_EQ(size.nonzeros, expected.nonzeros);
        EXPECT_EQ(size.flops, expected.flops);
        const std::vector<int> post = postorder(tree.parent);
        EXPECT_EQ(isPostordered(tree.parent), std::ranges::is_sorted(post));
      }
    }
  }
}

TEST(EliminationTree, postorderVisitsLightChildrenFirst) {
  const std::vector<int> parent{4, 4, 4, 5, 5, -1};
  EXPECT_EQ(postorder(parent), (std::vector<int>{3, 0, 1, 2, 4, 5}));
  const std::vector<double> weight{3.0, 1.0, 2.0, 9.0, 0.0, 0.0};
  EXPECT_EQ(postorder(parent, weight), (std::vector<int>{1, 2, 0, 4, 3, 5}));
}

volatile std::sig_atomic_t terminations = 0;

/// METIS catches SIGTERM while it runs; the program's own handler must be called all the same.
TEST(Ordering, aTerminationReachesItsHandler) {
  if (!hasMetis()) GTEST_SKIP() << "a build without METIS";
  std::mt19937 random(6);
  const BlockPattern pattern = randomPattern(Shape::grid, 40000, random);
  auto* const before = std::signal(SIGTERM, [](int) { terminations = terminations + 1; });
  // To the thread that orders: those of other libraries are not ours to keep from it.
  std::thread sender([orders = pthread_self()] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    pthread_kill(orders, SIGTERM);
  });
  const BlockOrdering ordering = metisOrdering(pattern);
  sender.join();
  std::signal(SIGTERM, before);
  EXPECT_EQ(terminations, 1);
  EXPECT_TRUE(isPermutation(ordering.order));
}

}  // namespace
}  // namespace quiver::test
