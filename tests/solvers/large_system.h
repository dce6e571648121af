#pragma once

#include <memory>
#include <random>
#include <vector>

#include <quiver/solvers/block/ordering.h>
#include <tests/solvers/random_system.h>

namespace quiver::test {

/// A grid with some chords, ordered by minimum degree: leaf subtrees and fronts.
inline BlockMatrix largeSystem(const std::vector<int>& choices, std::mt19937& random, int blocks = 900) {
  auto pairs = randomPairs(Shape::grid, blocks, random);
  for (int i = 0; i < blocks / 40; ++i) {
    pairs.emplace_back(static_cast<int>(random() % static_cast<unsigned>(blocks)),
                       static_cast<int>(random() % static_cast<unsigned>(blocks)));
  }
  const BlockPattern natural = BlockPattern::fromPairs(BlockLayout(randomDimensions(blocks, choices, random)), pairs);
  BlockMatrix matrix(std::make_shared<const BlockPattern>(natural.permuted(amdOrdering(natural).order)));
  fillDominant(matrix, random);
  return matrix;
}

}  // namespace quiver::test
