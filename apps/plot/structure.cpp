#include <quiver/apps/plot/structure.h>

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <quiver/core/problem/problem.h>
#include <quiver/core/util/error.h>
#include <quiver/solvers/block/factor_pattern.h>
#include <quiver/solvers/block/ordering.h>
#include <quiver/solvers/elimination/clique_pattern.h>
#include <quiver/solvers/elimination/elimination_choice.h>

namespace quiver::app {
namespace {

/// Collects blocks of scalars into cells.
class CellCounter {
 public:
  /// `triangle`: of diagonal blocks the lower triangles alone are stored.
  CellCounter(const std::string& title, const std::vector<std::int64_t>& begins, bool triangle = false)
      : begins_(begins), triangle_(triangle) {
    picture_.title = title;
    picture_.blocks = static_cast<std::int64_t>(begins.size()) - 1;
    picture_.scalars = begins.back();
    picture_.cells = static_cast<int>(std::min<std::int64_t>(MatrixPicture::mostCells, picture_.scalars));
    stored_.resize(static_cast<std::size_t>(picture_.cells) * static_cast<std::size_t>(picture_.cells));
  }

  void add(int row, int column) {
    const std::int64_t r0 = begin(row), r1 = begin(row + 1), c0 = begin(column), c1 = begin(column + 1);
    ++picture_.storedBlocks;
    picture_.storedScalars += triangle_ && row == column ? (r1 - r0) * (r1 - r0 + 1) / 2 : (r1 - r0) * (c1 - c0);
    for (int i = cellOf(r0); i <= cellOf(r1 - 1); ++i) {
      const double height = overlap(i, r0, r1);
      for (int j = cellOf(c0); j <= cellOf(c1 - 1); ++j) {
        stored_[static_cast<std::size_t>(i) * static_cast<std::size_t>(picture_.cells) + static_cast<std::size_t>(j)] +=
            height * overlap(j, c0, c1);
      }
    }
  }

  MatrixPicture finish() {
    const double side = static_cast<double>(picture_.scalars);
    picture_.fill = static_cast<double>(picture_.storedScalars) / (triangle_ ? 0.5 * side * (side + 1.0) : side * side);
    const double cell = side / picture_.cells;
    for (const double scalars : stored_) picture_.shares.push_back(static_cast<float>(scalars / (cell * cell)));
    return std::move(picture_);
  }

 private:
  std::int64_t begin(int block) const { return begins_[static_cast<std::size_t>(block)]; }
  int cellOf(std::int64_t scalar) const { return static_cast<int>(scalar * picture_.cells / picture_.scalars); }
  /// Scalars of [from, to) in a cell.
  double overlap(int cell, std::int64_t from, std::int64_t to) const {
    const double width = static_cast<double>(picture_.scalars) / picture_.cells;
    return std::max(
        0.0, std::min(static_cast<double>(to), (cell + 1) * width) - std::max(static_cast<double>(from), cell * width));
  }

  std::vector<std::int64_t> begins_;
  bool triangle_ = false;
  MatrixPicture picture_;
  std::vector<double> stored_;
};

std::vector<std::int64_t> beginsOf(const BlockLayout& layout, const std::vector<int>& order) {
  std::vector<std::int64_t> begins{0};
  for (const int block : order) begins.push_back(begins.back() + layout.dimension(block));
  return begins;
}

/// A symmetric pattern, its blocks in the given order.
MatrixPicture pictureSymmetric(const std::string& title, const BlockPattern& pattern, const std::vector<int>& order) {
  std::vector<int> position(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) position[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  const auto place = [&](int block) { return position[static_cast<std::size_t>(block)]; };
  CellCounter counter(title, beginsOf(pattern.layout(), order));
  for (int column = 0; column < pattern.blocks(); ++column) {
    counter.add(place(column), place(column));
    for (std::int64_t entry = pattern.columnBegin(column); entry < pattern.columnEnd(column); ++entry) {
      if (pattern.row(entry) == column) continue;
      counter.add(place(pattern.row(entry)), place(column));
      counter.add(place(column), place(pattern.row(entry)));
    }
  }
  return counter.finish();
}

/// What is factorised, before and after its ordering, and its factor.
void pictureFactorization(const std::string& title, const BlockPattern& pattern, std::vector<MatrixPicture>& pictures) {
  const BlockOrdering ordering = chooseOrdering(pattern);
  pictures.push_back(pictureSymmetric(title, pattern, naturalOrdering(pattern.blocks()).order));
  pictures.push_back(pictureSymmetric(fmt::format("the same, ordered ({})", ordering.name), pattern, ordering.order));
  const BlockGraph graph(pattern);
  const FactorPattern factor(graph, ordering.order, EliminationTree(graph, ordering.order));
  CellCounter counter("its Cholesky factor", beginsOf(pattern.layout(), ordering.order), true);
  for (int column = 0; column < pattern.blocks(); ++column) {
    counter.add(column, column);
    for (const int row : factor.column(column)) counter.add(row, column);
  }
  pictures.push_back(counter.finish());
}

/// H with its variables renumbered: position[variable].
BlockPattern hessianPattern(const Problem& problem, const std::vector<int>& position, const BlockLayout& layout) {
  std::vector<std::pair<int, int>> pairs;
  std::vector<int> variables;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    for (int i = 0; i < batch.size(); ++i) {
      variables.clear();
      for (const std::int32_t slot : batch.slots(i)) {
        const int variable = problem.variableOfSlot(slot);
        if (variable >= 0) variables.push_back(position[static_cast<std::size_t>(variable)]);
      }
      for (std::size_t k = 1; k < variables.size(); ++k) {
        for (std::size_t l = 0; l < k; ++l) pairs.emplace_back(variables[k], variables[l]);
      }
    }
  }
  return BlockPattern::fromPairs(layout, pairs);
}

}  // namespace

StructurePictures pictureStructure(Graph& graph, const Options& options) {
  graph.forEachVertex([&graph](Vertex& vertex) {
    if (!vertex.hasEstimate()) graph.typeOf(vertex).setToOrigin(vertex);
  });
  const Problem problem(graph, {.level = options.level, .free = options.free, .threads = 1});
  if (problem.variables() == 0) throw GraphError("no vertex is free, so there is no matrix to draw");
  const EliminationChoice choice = chooseElimination(problem, options);
  std::vector<int> position(static_cast<std::size_t>(problem.variables()));
  std::vector<int> dimensions;
  for (const char eliminated : {0, 1}) {
    for (int v = 0; v < problem.variables(); ++v) {
      if ((choice.eliminated[static_cast<std::size_t>(v)] != 0) != (eliminated != 0)) continue;
      position[static_cast<std::size_t>(v)] = static_cast<int>(dimensions.size());
      dimensions.push_back(problem.dimension(v));
    }
  }
  StructurePictures pictures;
  pictures.elimination = choice.reason;
  const BlockPattern hessian = hessianPattern(problem, position, BlockLayout(dimensions));
  if (choice.count == 0) {
    pictureFactorization("H", hessian, pictures.matrices);
    return pictures;
  }
  pictures.matrices.push_back(
      pictureSymmetric("H, eliminated vertices last", hessian, naturalOrdering(hessian.blocks()).order));
  const EliminationPlan plan(problem, choice.eliminated);
  if (plan.kept() == 0) return pictures;
  const BlockPattern reduced = cliquePattern(plan.keptLayout(), PointNeighbours(plan), directPairs(plan));
  pictureFactorization("reduced matrix, who shares landmarks", reduced, pictures.matrices);
  return pictures;
}

}  // namespace quiver::app
