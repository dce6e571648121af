#include <quiver/smoothing/selected_inverse.h>

#include <limits>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "tests/solvers/random_system.h"

namespace quiver::test {
namespace {

struct Case {
  Shape shape;
  int blocks;
  std::vector<int> dimensions;
};

class SelectedInverseOf : public testing::TestWithParam<Case> {};

TEST_P(SelectedInverseOf, RandomMatricesIsTheDenseOne) {
  std::mt19937 random(11);
  for (int round = 0; round < 8; ++round) {
    const BlockMatrix matrix = randomSystem(GetParam().shape, GetParam().blocks, GetParam().dimensions, random);
    const BlockLayout& layout = matrix.layout();
    const Eigen::MatrixXd dense = toDense(matrix).inverse();
    const SelectedInverse inverse(matrix);
    ASSERT_TRUE(inverse.pinned().empty());
    for (int i = 0; i < layout.blocks(); ++i) {
      for (int j = 0; j < layout.blocks(); ++j) {
        const auto block = inverse.find(i, j);
        const bool stored = matrix.pattern().find(std::max(i, j), std::min(i, j)) >= 0;
        ASSERT_TRUE(block || !stored) << i << " " << j;
        if (!block) continue;
        const auto expected = dense.block(layout.offset(i), layout.offset(j), layout.dimension(i), layout.dimension(j));
        ASSERT_EQ(block->rows(), layout.dimension(i));
        ASSERT_EQ(block->cols(), layout.dimension(j));
        EXPECT_LE((*block - expected).norm(), 1e-12 * dense.norm()) << i << " " << j;
      }
    }
    const Eigen::MatrixXd b = randomVector(3 * layout.scalars(), random).reshaped(layout.scalars(), 3);
    EXPECT_LE((inverse.solve(b) - dense * b).norm(), 1e-12 * dense.norm() * b.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SelectedInverseOf,
                         testing::Values(Case{Shape::random, 30, {3}}, Case{Shape::random, 25, {1, 2, 3, 6, 9}},
                                         Case{Shape::chain, 60, {3, 6}}, Case{Shape::grid, 49, {6}},
                                         Case{Shape::arrow, 40, {3, 9}}, Case{Shape::disconnected, 31, {1, 3}},
                                         Case{Shape::full, 20, {9}}, Case{Shape::random, 1, {1}},
                                         Case{Shape::chain, 2, {6}}));

/// Ones on the diagonal and a pair of blocks that are the same up to `difference`.
BlockMatrix twins(double difference) {
  const std::vector<std::pair<int, int>> pairs{{1, 0}, {2, 1}};
  BlockMatrix matrix(std::make_shared<const BlockPattern>(BlockPattern::fromPairs(BlockLayout({2, 2, 2}), pairs)));
  for (int i = 0; i < 3; ++i) {
    double* block = matrix.block(matrix.pattern().find(i, i));
    block[0] = block[3] = 1.0;
  }
  matrix.block(matrix.pattern().find(1, 0))[3] = 1.0 - difference;
  return matrix;
}

TEST(SelectedInverse, LeavesOutWhatHasNoInverse) {
  for (const double difference : {0.0, 1e-16}) {
    const SelectedInverse inverse(twins(difference));
    ASSERT_EQ(inverse.pinned().size(), 1u) << difference;
    EXPECT_LE(inverse.pinned().front().block, 1);
    EXPECT_EQ(inverse.pinned().front().coordinate, 1);
    EXPECT_EQ(inverse.pinned().front().moved.size(), 2u);
    EXPECT_EQ(*inverse.find(2, 2), Eigen::MatrixXd::Identity(2, 2));
    Eigen::MatrixXd other = Eigen::MatrixXd::Identity(2, 2);
    const int pinned = inverse.pinned().front().block;
    EXPECT_EQ(*inverse.find(1 - pinned, 1 - pinned), other);
    other(1, 1) = 0.0;
    EXPECT_EQ(*inverse.find(pinned, pinned), other);
    EXPECT_EQ(*inverse.find(0, 1), Eigen::MatrixXd::Zero(2, 2));
  }
  EXPECT_TRUE(SelectedInverse(twins(1e-6)).pinned().empty());
}

/// Without a row and a column, a random matrix has the dense inverse of what is left.
TEST(SelectedInverse, IsTheInverseOfTheRest) {
  std::mt19937 random(5);
  for (int round = 0; round < 20; ++round) {
    BlockMatrix matrix = randomSystem(Shape::random, 12, {1, 3, 6}, random);
    const BlockLayout& layout = matrix.layout();
    // A zero on the diagonal pins the coordinate, whatever stands beside it.
    const int block = round % 12;
    const int coordinate = layout.dimension(block) - 1;
    matrix.block(matrix.pattern().find(block, block))[coordinate * (layout.dimension(block) + 1)] = 0.0;
    Eigen::MatrixXd dense = toDense(matrix);
    const Eigen::Index at = layout.offset(block) + coordinate;
    dense.row(at).setZero();
    dense.col(at).setZero();
    dense(at, at) = 1.0;
    dense = dense.inverse().eval();
    dense(at, at) = 0.0;
    const SelectedInverse inverse(matrix);
    ASSERT_EQ(inverse.pinned().size(), 1u);
    EXPECT_EQ(inverse.pinned().front().block, block);
    for (int i = 0; i < layout.blocks(); ++i) {
      const auto expected = dense.block(layout.offset(i), layout.offset(i), layout.dimension(i), layout.dimension(i));
      EXPECT_LE((*inverse.find(i, i) - expected).norm(), 1e-12 * dense.norm()) << round << " " << i;
    }
    const Eigen::VectorXd b = randomVector(layout.scalars(), random);
    EXPECT_LE((inverse.solve(b) - dense * b).norm(), 1e-12 * dense.norm() * b.norm());
  }
}

TEST(SelectedInverse, LeavesOutWhatIsNotANumber) {
  BlockMatrix matrix = twins(0.5);
  matrix.block(matrix.pattern().find(2, 2))[0] = std::numeric_limits<double>::quiet_NaN();
  const SelectedInverse inverse(matrix);
  ASSERT_FALSE(inverse.pinned().empty());
  EXPECT_EQ(inverse.pinned().front().block, 2);
}

}  // namespace
}  // namespace quiver::test
