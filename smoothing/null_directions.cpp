#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include <quiver/smoothing/selected_inverse.h>

// The part of SelectedInverse that looks for directions along which the matrix vanishes. Such a direction n, with 1 at
// a coordinate s and zeros behind it in the order of elimination, is n_b = −A_bb⁻¹ a_bs for the coordinates b before s;
// those that matter are descendants of s in the elimination tree, neighbours of each other in a postorder.

namespace quiver {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Of Σ |n_i A_ij n_j|, what the rounding of A leaves of nᵀ A n = 0.
constexpr double rounding = 3e-15;
/// Of the largest movement, each measured by the root of its diagonal entry.
constexpr double moves = 1e-6;

}  // namespace

void SelectedInverse::listNeighbours(const BlockMatrix& matrix) {
  if (!neighbours_.empty()) return;
  const BlockPattern& pattern = matrix.pattern();
  neighbours_.resize(order_.size());
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      const int row = pattern.row(k);
      neighbours_[position_[row]].push_back({position_[column], k, false});
      if (row != column) neighbours_[position_[column]].push_back({position_[row], k, true});
    }
  }
}

/// y ← A x for the rows of the positions first … last, over columns of those positions before scalar `end` alone.
void SelectedInverse::multiplyRows(const BlockMatrix& matrix, int first, int last, Index end, const VectorXd& x,
                                   VectorXd& y) const {
  for (int position = first; position <= last; ++position) {
    auto own = y.segment(begin_[position], size(position));
    own.setZero();
    for (const Neighbour& other : neighbours_[position]) {
      if (other.position < first || other.position > last) continue;
      const Index width = std::min(size(other.position), end - begin_[other.position]);
      if (width <= 0) continue;
      const auto part = x.segment(begin_[other.position], width);
      if (other.transposed) {
        const Eigen::Map<const Eigen::MatrixXd> block(matrix.block(other.entry), size(other.position), size(position));
        own.noalias() += block.topRows(width).transpose() * part;
      } else {
        const Eigen::Map<const Eigen::MatrixXd> block(matrix.block(other.entry), size(position), size(other.position));
        own.noalias() += block.leftCols(width) * part;
      }
    }
  }
}

/// x ← A_bb⁻¹ x, b the scalars before `end` that it depends on; pinned ones among them become zero.
void SelectedInverse::solveLeading(Index end, VectorXd& x) const {
  const int position = positionOf(end);
  const int firstPanel = panelOf_[firstDescendant_[position]];
  const int lastPanel = panelOf_[position];
  const Index first = begin_[firstDescendant_[position]];
  for (Index k = first; k < end; ++k) {
    if (isPinned_[k]) x[k] = 0.0;
  }
  // Rows of a panel that lie before the end, scalar by scalar in the last block.
  const auto forEachRow = [&](const Panel& panel, const auto& visit) {
    for (std::size_t i = 0; i < panel.rows.size() && panel.rows[i] <= position; ++i) {
      const Index begin = begin_[panel.rows[i]];
      const Index count = std::min(size(panel.rows[i]), end - begin);
      if (count > 0) visit(panel.factor.block(panel.rowBegin[i], 0, count, panel.columns()), begin, count);
    }
  };
  const auto columnsOf = [&](const Panel& panel) { return std::min(panel.columns(), end - begin_[panel.first]); };
  for (int p = firstPanel; p <= lastPanel; ++p) {
    const Panel& panel = panels_[p];
    const Index columns = columnsOf(panel);
    if (columns <= 0) continue;
    auto own = x.segment(begin_[panel.first], columns);
    panel.factor.topLeftCorner(columns, columns).triangularView<Eigen::Lower>().solveInPlace(own);
    if (columns < panel.columns()) continue;
    forEachRow(panel,
               [&](const auto& block, Index begin, Index count) { x.segment(begin, count).noalias() -= block * own; });
  }
  for (int p = lastPanel; p >= firstPanel; --p) {
    const Panel& panel = panels_[p];
    const Index columns = columnsOf(panel);
    if (columns <= 0) continue;
    auto own = x.segment(begin_[panel.first], columns);
    if (columns == panel.columns()) {
      forEachRow(panel, [&](const auto& block, Index begin, Index count) {
        own.noalias() -= block.transpose() * x.segment(begin, count);
      });
    }
    panel.factor.topLeftCorner(columns, columns).transpose().triangularView<Eigen::Upper>().solveInPlace(own);
  }
}

/// Σ |x_i A_ij x_j| over the positions first … last: what nᵀ A n was added up from.
double SelectedInverse::sumOfSizes(const BlockMatrix& matrix, int first, int last, const VectorXd& x) const {
  double sum = 0.0;
  for (int position = first; position <= last; ++position) {
    const auto own = x.segment(begin_[position], size(position)).cwiseAbs();
    for (const Neighbour& other : neighbours_[position]) {
      if (other.position < first || other.position > last) continue;
      const Index rows = size(other.transposed ? other.position : position);
      const Index columns = size(other.transposed ? position : other.position);
      const Eigen::MatrixXd block =
          Eigen::Map<const Eigen::MatrixXd>(matrix.block(other.entry), rows, columns).cwiseAbs();
      const VectorXd part = x.segment(begin_[other.position], size(other.position)).cwiseAbs();
      sum += own.dot(other.transposed ? VectorXd(block.transpose() * part) : VectorXd(block * part));
    }
  }
  return sum;
}

/// The direction of a scalar, refined once, from its first descendant to itself; returns nᵀ A n, which is the scalar's
/// pivot, as a share of what it was added up from.
double SelectedInverse::findDirection(const BlockMatrix& matrix, Index scalar, VectorXd& direction,
                                      VectorXd& work) const {
  const int position = positionOf(scalar);
  const int first = firstDescendant_[position];
  const Index begin = begin_[first];
  const Index count = scalar - begin;
  direction.segment(begin, begin_[position + 1] - begin).setZero();
  direction[scalar] = 1.0;
  for (int step = 0; step < 2; ++step) {
    multiplyRows(matrix, first, position, scalar + 1, direction, work);
    // Coordinates left out are known: nothing pulls at them.
    solveLeading(scalar, work);
    direction.segment(begin, count) -= work.segment(begin, count);
  }
  multiplyRows(matrix, first, position, scalar + 1, direction, work);
  const double product = direction.segment(begin, count + 1).dot(work.segment(begin, count + 1));
  return product / sumOfSizes(matrix, first, position, direction);
}

/// Marks the small pivots that are nothing but rounding; whether there are any.
bool SelectedInverse::pinSuspects(const BlockMatrix& matrix, const StopCondition& stop) {
  listNeighbours(matrix);
  VectorXd direction = VectorXd::Zero(begin_.back());
  VectorXd work = direction;
  std::vector<Index> found;
  for (const Index scalar : suspects_) {
    if (stop.reached()) return false;
    if (!(findDirection(matrix, scalar, direction, work) > rounding)) found.push_back(scalar);
  }
  for (const Index scalar : found) isPinned_[scalar] = 1;
  return !found.empty();
}

void SelectedInverse::describePinned(const BlockMatrix& matrix, const StopCondition& stop) {
  listNeighbours(matrix);
  VectorXd direction = VectorXd::Zero(begin_.back());
  VectorXd work = direction;
  for (Index scalar = 0; scalar < begin_.back() && !stop.reached(); ++scalar) {
    if (!isPinned_[scalar]) continue;
    (void)findDirection(matrix, scalar, direction, work);
    const int position = positionOf(scalar);
    const int first = firstDescendant_[position];
    const Index begin = begin_[first];
    const Index count = begin_[position + 1] - begin;
    const VectorXd lengths =
        direction.segment(begin, count).cwiseAbs().cwiseProduct(diagonal_.segment(begin, count).cwiseAbs().cwiseSqrt());
    const double least = moves * lengths.head(scalar - begin + 1).maxCoeff();
    Pinned pinned{order_[position], static_cast<int>(scalar - begin_[position]), {}};
    for (int j = first; j <= position; ++j) {
      if (j == position || !(lengths.segment(begin_[j] - begin, size(j)).maxCoeff() <= least))
        pinned.moved.push_back(order_[j]);
    }
    pinned_.push_back(std::move(pinned));
  }
}

}  // namespace quiver
