#include "factorization/graph_patterns.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include <quiver/core/util/error.h>

namespace quiver::bench {
namespace {

GraphPattern fromEdges(std::string name, int dimension, const std::vector<std::pair<long, long>>& edges) {
  std::map<long, int> index;
  for (const auto& [i, j] : edges) {
    index.emplace(i, 0);
    index.emplace(j, 0);
  }
  int count = -1;  // the smallest id is fixed
  for (auto& entry : index) entry.second = count++;
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [i, j] : edges) {
    if (index[i] >= 0 && index[j] >= 0) pairs.emplace_back(index[i], index[j]);
  }
  BlockLayout layout(std::vector<int>(static_cast<std::size_t>(std::max(count, 0)), dimension));
  return {std::move(name), BlockPattern::fromPairs(std::move(layout), pairs)};
}

}  // namespace

GraphPattern readGraphPattern(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw FileError(path + ": cannot be opened");
  std::vector<std::pair<long, long>> edges;
  int dimension = 3;
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, 4, "EDGE") != 0) continue;
    std::istringstream fields(line.substr(0, 80));
    std::string tag;
    long i = 0;
    long j = 0;
    if (!(fields >> tag >> i >> j)) continue;
    if (tag.find("SE3") != std::string::npos) dimension = 6;
    edges.emplace_back(i, j);
  }
  return fromEdges(std::filesystem::path(path).stem().string(), dimension, edges);
}

GraphPattern simulateManhattan(int poses) {
  std::mt19937 random(1);
  std::map<std::pair<int, int>, std::vector<int>> visits;
  std::vector<std::pair<long, long>> edges;
  int x = 0;
  int y = 0;
  int heading = 0;
  const int half = static_cast<int>(std::sqrt(poses) / 2.0);
  for (int pose = 0; pose < poses; ++pose) {
    if (pose > 0) edges.emplace_back(pose - 1, pose);
    auto& here = visits[{x, y}];
    if (!here.empty()) edges.emplace_back(here.back(), pose);
    here.push_back(pose);
    if (pose % 4 == 3) heading = (heading + (random() % 3) + 3) % 4;  // left, straight or right at a crossing
    const int dx = heading == 0 ? 1 : heading == 2 ? -1 : 0;
    const int dy = heading == 1 ? 1 : heading == 3 ? -1 : 0;
    if (std::abs(x + dx) > half || std::abs(y + dy) > half) heading = (heading + 2) % 4;
    x += heading == 0 ? 1 : heading == 2 ? -1 : 0;
    y += heading == 1 ? 1 : heading == 3 ? -1 : 0;
  }
  return fromEdges("manhattan" + std::to_string(poses), 3, edges);
}

BlockMatrix dominantValues(std::shared_ptr<const BlockPattern> shared) {
  BlockMatrix matrix(std::move(shared));
  const BlockPattern& pattern = matrix.pattern();
  const BlockLayout& layout = pattern.layout();
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> sums(static_cast<std::size_t>(layout.scalars()), 1.0);
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (auto k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      const int rows = layout.dimension(pattern.row(k));
      double* block = matrix.block(k);
      for (int c = 0; c < layout.dimension(column); ++c) {
        for (int r = 0; r < rows; ++r) {
          const bool diagonal = pattern.row(k) == column;
          block[c * rows + r] = diagonal && r < c ? block[r * rows + c] : uniform(random);
          const double size = std::abs(block[c * rows + r]);
          sums[static_cast<std::size_t>(layout.offset(pattern.row(k)) + r)] += size;
          if (!diagonal) sums[static_cast<std::size_t>(layout.offset(column) + c)] += size;
        }
      }
    }
  }
  for (int column = 0; column < pattern.blocks(); ++column) {
    double* block = matrix.block(pattern.columnBegin(column));
    const int dimension = layout.dimension(column);
    for (int c = 0; c < dimension; ++c)
      block[c * (dimension + 1)] = sums[static_cast<std::size_t>(layout.offset(column) + c)];
  }
  return matrix;
}

}  // namespace quiver::bench
