#pragma once

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include <quiver/solvers/block/block_matrix.h>

namespace quiver::test {

enum class Shape { random, chain, grid, arrow, disconnected, full };

inline const char* toString(Shape shape) {
  switch (shape) {
    case Shape::random:
      return "random";
    case Shape::chain:
      return "chain";
    case Shape::grid:
      return "grid";
    case Shape::arrow:
      return "arrow";
    case Shape::disconnected:
      return "disconnected";
    case Shape::full:
      return "full";
  }
  return "?";
}

inline std::vector<std::pair<int, int>> randomPairs(Shape shape, int blocks, std::mt19937& random) {
  std::vector<std::pair<int, int>> pairs;
  const auto pick = [&](int count) { return std::uniform_int_distribution<int>(0, count - 1)(random); };
  const int width = std::max(1, static_cast<int>(std::sqrt(blocks)));
  for (int i = 0; i < blocks; ++i) {
    switch (shape) {
      case Shape::random:
        if (i > 0) pairs.emplace_back(i, pick(i));
        pairs.emplace_back(pick(blocks), pick(blocks));
        break;
      case Shape::chain:
        if (i > 0) pairs.emplace_back(i, i - 1);
        if (i % 7 == 3) pairs.emplace_back(pick(blocks), i);
        break;
      case Shape::grid:
        if (i % width != 0) pairs.emplace_back(i, i - 1);
        if (i >= width) pairs.emplace_back(i, i - width);
        break;
      case Shape::arrow:
        pairs.emplace_back(i, blocks - 1);
        pairs.emplace_back(i, blocks / 2);
        break;
      case Shape::disconnected:
        if (i % 5 != 0) pairs.emplace_back(i, i - 1 - pick(i % 5));
        break;
      case Shape::full:
        for (int j = 0; j < i; ++j) pairs.emplace_back(i, j);
        break;
    }
  }
  return pairs;
}

inline std::vector<int> randomDimensions(int blocks, const std::vector<int>& choices, std::mt19937& random) {
  std::vector<int> dimensions(static_cast<std::size_t>(blocks));
  for (int& dimension : dimensions) {
    dimension = choices[std::uniform_int_distribution<std::size_t>(0, choices.size() - 1)(random)];
  }
  return dimensions;
}

/// The whole symmetric matrix, dense.
inline Eigen::MatrixXd toDense(const BlockMatrix& matrix) {
  const BlockPattern& pattern = matrix.pattern();
  const BlockLayout& layout = pattern.layout();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(layout.scalars(), layout.scalars());
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      const int row = pattern.row(k);
      const Eigen::Map<const Eigen::MatrixXd> block(matrix.block(k), layout.dimension(row), layout.dimension(column));
      dense.block(layout.offset(row), layout.offset(column), block.rows(), block.cols()) = block;
      dense.block(layout.offset(column), layout.offset(row), block.cols(), block.rows()) = block.transpose();
    }
  }
  return dense;
}

/// Random symmetric values with a dominant diagonal: positive definite, condition of about 10 to 100.
inline void fillDominant(BlockMatrix& matrix, std::mt19937& random) {
  const BlockPattern& pattern = matrix.pattern();
  const BlockLayout& layout = pattern.layout();
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (double& value : matrix.values()) value = uniform(random);
  std::vector<double> sums(static_cast<std::size_t>(layout.scalars()), 0.1);
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      const int row = pattern.row(k);
      const int rows = layout.dimension(row);
      double* block = matrix.block(k);
      for (int c = 0; c < layout.dimension(column); ++c) {
        for (int r = 0; r < rows; ++r) {
          if (row == column && r < c) block[c * rows + r] = block[r * rows + c];
          sums[static_cast<std::size_t>(layout.offset(row) + r)] += std::abs(block[c * rows + r]);
          if (row != column) sums[static_cast<std::size_t>(layout.offset(column) + c)] += std::abs(block[c * rows + r]);
        }
      }
    }
  }
  for (int column = 0; column < pattern.blocks(); ++column) {
    const int dimension = layout.dimension(column);
    double* block = matrix.block(pattern.columnBegin(column));
    for (int c = 0; c < dimension; ++c)
      block[c * (dimension + 1)] = sums[static_cast<std::size_t>(layout.offset(column) + c)];
  }
}

/// A random pattern in its natural order with dominant values.
inline BlockMatrix randomSystem(Shape shape, int blocks, const std::vector<int>& choices, std::mt19937& random) {
  BlockLayout layout(randomDimensions(blocks, choices, random));
  BlockMatrix matrix(
      std::make_shared<const BlockPattern>(BlockPattern::fromPairs(layout, randomPairs(shape, blocks, random))));
  fillDominant(matrix, random);
  return matrix;
}

inline Eigen::VectorXd randomVector(Eigen::Index size, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(random); });
}

}  // namespace quiver::test
