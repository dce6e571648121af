#include <gtest/gtest.h>

#include <map>

#include <quiver/core/util/error.h>
#include <tests/solvers/random_system.h>

namespace quiver::test {
namespace {

TEST(BlockPattern, holdsEveryPairOnceInTheLowerTriangle) {
  std::mt19937 random(1);
  for (const Shape shape : {Shape::random, Shape::grid, Shape::arrow, Shape::disconnected}) {
    const int blocks = 37;
    auto pairs = randomPairs(shape, blocks, random);
    pairs.emplace_back(3, 9);
    pairs.emplace_back(9, 3);
    const BlockPattern pattern =
        BlockPattern::fromPairs(BlockLayout(randomDimensions(blocks, {1, 3, 6}, random)), pairs);
    std::set<std::pair<int, int>> expected;
    for (int i = 0; i < blocks; ++i) expected.emplace(i, i);
    for (const auto& [i, j] : pairs) expected.emplace(std::min(i, j), std::max(i, j));  // (column, row)
    ASSERT_EQ(pattern.entries(), static_cast<std::int64_t>(expected.size()));
    auto it = expected.begin();
    for (int column = 0; column < blocks; ++column) {
      for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k, ++it) {
        EXPECT_EQ(*it, std::make_pair(column, pattern.row(k)));
        EXPECT_EQ(pattern.find(pattern.row(k), column), k);
      }
    }
    EXPECT_EQ(pattern.find(blocks - 1, blocks - 2) >= 0, expected.count({blocks - 2, blocks - 1}) == 1);
  }
}

TEST(BlockPattern, permutesLikeAMatrix) {
  std::mt19937 random(2);
  const BlockMatrix matrix = randomSystem(Shape::random, 23, {1, 2, 7}, random);
  std::vector<int> order(23);
  for (int i = 0; i < 23; ++i) order[static_cast<std::size_t>(i)] = i;
  std::shuffle(order.begin(), order.end(), random);
  const BlockPattern permuted = matrix.pattern().permuted(order);
  EXPECT_EQ(permuted.entries(), matrix.pattern().entries());
  for (int i = 0; i < 23; ++i) {
    EXPECT_EQ(permuted.layout().dimension(i), matrix.layout().dimension(order[static_cast<std::size_t>(i)]));
    for (int j = 0; j <= i; ++j) {
      const int a = order[static_cast<std::size_t>(i)];
      const int b = order[static_cast<std::size_t>(j)];
      EXPECT_EQ(permuted.find(i, j) >= 0, matrix.pattern().find(std::max(a, b), std::min(a, b)) >= 0);
    }
  }
}

TEST(BlockPattern, refusesWhatIsNoPattern) {
  const BlockLayout layout({2, 3});
  const std::vector<std::pair<int, int>> outside{{0, 2}};
  EXPECT_THROW(BlockPattern::fromPairs(layout, outside), LogicError);
  EXPECT_THROW(BlockLayout({2, 0}), LogicError);
  const BlockPattern pattern = BlockPattern::fromPairs(layout, {});
  EXPECT_THROW(pattern.permuted(std::vector<int>{0, 0}), LogicError);
  EXPECT_THROW(pattern.permuted(std::vector<int>{0}), LogicError);
}

TEST(BlockMatrix, multipliesLikeTheDenseMatrix) {
  std::mt19937 random(3);
  for (const Shape shape : {Shape::random, Shape::arrow, Shape::full}) {
    const BlockMatrix matrix = randomSystem(shape, 17, {1, 2, 3, 6, 7, 9}, random);
    const Eigen::MatrixXd dense = toDense(matrix);
    const Eigen::VectorXd x = randomVector(dense.rows(), random);
    Eigen::VectorXd y(dense.rows());
    matrix.multiply({x.data(), static_cast<std::size_t>(x.size())}, {y.data(), static_cast<std::size_t>(y.size())});
    EXPECT_LE((y - dense * x).norm(), 1e-14 * dense.norm() * x.norm());  // a few roundings a product
    Eigen::VectorXd diagonal(dense.rows());
    matrix.diagonal({diagonal.data(), static_cast<std::size_t>(diagonal.size())});
    EXPECT_EQ(diagonal, dense.diagonal());
  }
}

}  // namespace
}  // namespace quiver::test
