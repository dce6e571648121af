#include <quiver/smoothing/selected_inverse.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include <quiver/solvers/block/elimination_tree.h>
#include <quiver/solvers/block/factor_pattern.h>
#include <quiver/solvers/block/ordering.h>

namespace quiver {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A pivot below this share of A's diagonal entry is rounding; below the second share it may be.
constexpr double pivotFloor = 1e-14;
constexpr double pivotSuspect = 1e-5;

/// Which pivots of a panel are small, by its columns.
struct SmallPivots {
  std::vector<Index> left;  // out
  std::vector<Index> suspect;
};

/// Cholesky of the first panel.cols() rows, and L = A L_d⁻ᵀ for the rows below. Columns whose pivot is rounding, or
/// that are to be left out, become those of the identity.
void factorColumns(MatrixXd& panel, const VectorXd& diagonal, const char* leaveOut, const StopCondition& stop,
                   SmallPivots& small) {
  constexpr Index chunk = 48;
  for (Index k = 0; k < panel.cols() && !stop.reached(); k += chunk) {
    const Index width = std::min(chunk, panel.cols() - k);
    auto d = panel.block(k, k, width, width);
    for (Index j = 0; j < width; ++j) {
      const double pivot = d(j, j) - d.row(j).head(j).squaredNorm();
      if (leaveOut[k + j] || !(pivot > pivotFloor * diagonal[k + j]) || !std::isfinite(pivot)) {
        small.left.push_back(k + j);
        panel.col(k + j).setZero();
        panel.row(k + j).head(k + j).setZero();
        d(j, j) = 1.0;
        continue;
      }
      if (pivot <= pivotSuspect * diagonal[k + j]) small.suspect.push_back(k + j);
      d(j, j) = std::sqrt(pivot);
      for (Index i = j + 1; i < width; ++i) d(i, j) = (d(i, j) - d.row(i).head(j).dot(d.row(j).head(j))) / d(j, j);
    }
    if (panel.rows() == k + width) break;
    const Index rest = panel.cols() - k - width;
    auto below = panel.block(k + width, k, panel.rows() - k - width, width);
    d.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
    if (rest > 0)
      panel.block(k + width, k + width, below.rows(), rest).noalias() -= below * below.topRows(rest).transpose();
  }
}

}  // namespace

SelectedInverse::SelectedInverse(const BlockMatrix& matrix, const StopCondition& stop) {
  layOut(matrix, chooseOrdering(matrix.pattern()).order);
  load(matrix);
  factorize(stop);
  // What is left out changes the pivots behind it: a second look suffices, since directions are told apart by then.
  if (!suspects_.empty() && pinSuspects(matrix, stop)) {
    load(matrix);
    factorize(stop);
  }
  if (anyPinned_) describePinned(matrix, stop);
  for (auto panel = panels_.rbegin(); panel != panels_.rend() && !stop.reached(); ++panel) invert(*panel, stop);
  stopped_ = stop.reached();
}

std::int64_t SelectedInverse::predictBytes(const BlockPattern& pattern) {
  // L and the inverse, whose diagonal blocks are whole, and lists.
  constexpr double bytesEach = 2.2 * 8.0;
  return static_cast<std::int64_t>(bytesEach *
                                   static_cast<double>(predictFactor(pattern, chooseOrdering(pattern).order).nonzeros));
}

void SelectedInverse::layOut(const BlockMatrix& matrix, const std::vector<int>& order) {
  const BlockLayout& layout = matrix.layout();
  const BlockGraph graph(matrix.pattern());
  const EliminationTree tree(graph, order);
  const FactorPattern factor(graph, order, tree);
  position_ = positionsOf(order);
  order_ = order;
  firstDescendant_ = naturalOrdering(static_cast<int>(order.size())).order;
  for (std::size_t j = 0; j < order.size(); ++j) {
    if (const int up = tree.parent[j]; up >= 0)
      firstDescendant_[up] = std::min(firstDescendant_[up], firstDescendant_[j]);
  }
  begin_.push_back(0);
  for (const int block : order) {
    begin_.push_back(begin_.back() + layout.dimension(block));
    source_.push_back(layout.offset(block));
  }
  for (int j = 0; j < static_cast<int>(order.size()); ++j) {
    const auto rows = factor.column(j);
    const bool joins = j > 0 && tree.parent[j - 1] == j && factor.column(j - 1).size() == rows.size() + 1;
    if (!joins) panels_.emplace_back().first = j;
    Panel& panel = panels_.back();
    panel.end = j + 1;
    panel.rows.assign(rows.begin(), rows.end());
    panelOf_.push_back(static_cast<int>(panels_.size()) - 1);
  }
  for (Panel& panel : panels_) {
    Index scalars = begin_[panel.end] - begin_[panel.first];
    const Index columns = scalars;
    for (const int row : panel.rows) {
      panel.rowBegin.push_back(scalars);
      scalars += size(row);
    }
    panel.rowBegin.push_back(scalars);
    panel.factor.resize(scalars, columns);
  }
  isPinned_.assign(static_cast<std::size_t>(begin_.back()), 0);
}

void SelectedInverse::load(const BlockMatrix& matrix) {
  for (Panel& panel : panels_) panel.factor.setZero();
  const BlockPattern& pattern = matrix.pattern();
  for (int column = 0; column < pattern.blocks(); ++column) {
    for (std::int64_t k = pattern.columnBegin(column); k < pattern.columnEnd(column); ++k) {
      const int row = pattern.row(k);
      const Eigen::Map<const MatrixXd> block(matrix.block(k), matrix.layout().dimension(row),
                                             matrix.layout().dimension(column));
      const int i = std::max(position_[row], position_[column]);
      const int j = std::min(position_[row], position_[column]);
      Panel& panel = panels_[panelOf_[j]];
      auto target = panel.factor.block(placeOf(panel, i), placeOf(panel, j), size(i), size(j));
      if (i == position_[row]) {
        target = block;
      } else {
        target = block.transpose();
      }
    }
  }
}

void SelectedInverse::factorize(const StopCondition& stop) {
  diagonal_.resize(begin_.back());
  for (const Panel& panel : panels_) diagonal_.segment(begin_[panel.first], panel.columns()) = panel.factor.diagonal();
  suspects_.clear();
  SmallPivots small;
  for (std::size_t p = 0; p < panels_.size() && !stop.reached(); ++p) {
    Panel& panel = panels_[p];
    const Index first = begin_[panel.first];
    small.left.clear();
    small.suspect.clear();
    factorColumns(panel.factor, diagonal_.segment(first, panel.columns()), isPinned_.data() + first, stop, small);
    for (const Index column : small.left) pin(static_cast<int>(p), column);
    for (const Index column : small.suspect) suspects_.push_back(first + column);
    subtractProduct(panel);
  }
}

int SelectedInverse::positionOf(Index scalar) const {
  return static_cast<int>(std::upper_bound(begin_.begin(), begin_.end(), scalar) - begin_.begin()) - 1;
}

/// Leaves a coordinate out of the panels before that have its row.
void SelectedInverse::pin(int panel, Index column) {
  const Index scalar = begin_[panels_[panel].first] + column;
  const int position = positionOf(scalar);
  for (int p = panelOf_[firstDescendant_[position]]; p < panel; ++p) {
    const Index place = placeOf(panels_[p], position);
    if (place >= 0) panels_[p].factor.row(place + scalar - begin_[position]).setZero();
  }
  isPinned_[scalar] = 1;
  anyPinned_ = true;
}

void SelectedInverse::subtractProduct(const Panel& panel) {
  if (panel.below() == 0) return;  // Eigen divides by it
  MatrixXd product = MatrixXd::Zero(panel.below(), panel.below());
  product.selfadjointView<Eigen::Lower>().rankUpdate(panel.factor.bottomRows(panel.below()));
  const Index own = panel.columns();
  forEachPair(panel, [&](int ancestor, Index row, Index column, std::size_t i, std::size_t j) {
    const Index height = size(panel.rows[i]);
    const Index width = size(panel.rows[j]);
    panels_[ancestor].factor.block(row, column, height, width) -=
        product.block(panel.rowBegin[i] - own, panel.rowBegin[j] - own, height, width);
  });
}

/// With Y = L_r L_c⁻¹ and the inverse Z_rr of the rows below, which ancestors hold: Z_rc = −Z_rr Y and
/// Z_cc = (L_c L_cᵀ)⁻¹ − Yᵀ Z_rc.
void SelectedInverse::invert(Panel& panel, const StopCondition& stop) const {
  const Index own = panel.columns();
  const Index below = panel.below();
  const auto diagonal = panel.factor.topRows(own).triangularView<Eigen::Lower>();
  const MatrixXd inverse = diagonal.solve(MatrixXd::Identity(own, own));
  panel.inverse.resize(own + below, own);
  constexpr Index chunk = 256;  // columns between two looks at the clock
  for (Index c = 0; c < own && !stop.reached(); c += chunk) {
    const Index width = std::min(chunk, own - c);
    panel.inverse.block(0, c, own, width).noalias() = inverse.transpose() * inverse.middleCols(c, width);
  }
  if (below == 0) return;
  MatrixXd rows(below, below);
  forEachPair(panel, [&](int ancestor, Index row, Index column, std::size_t i, std::size_t j) {
    rows.block(panel.rowBegin[i] - own, panel.rowBegin[j] - own, size(panel.rows[i]), size(panel.rows[j])) =
        panels_[ancestor].inverse.block(row, column, size(panel.rows[i]), size(panel.rows[j]));
  });
  const MatrixXd y = diagonal.solve<Eigen::OnTheRight>(panel.factor.bottomRows(below));
  panel.inverse.bottomRows(below).noalias() = rows.selfadjointView<Eigen::Lower>() * (-y);
  MatrixXd product = y.transpose() * panel.inverse.bottomRows(below);
  panel.inverse.topRows(own) -= 0.5 * (product + product.transpose());
}

template <typename Visit>
void SelectedInverse::forEachPair(const Panel& panel, const Visit& visit) const {
  std::vector<Index> places(panel.rows.size());
  for (std::size_t j = 0; j < panel.rows.size(); ++j) {
    const int ancestor = panelOf_[panel.rows[j]];
    const Panel& target = panels_[ancestor];
    if (j == 0 || panelOf_[panel.rows[j - 1]] != ancestor) {
      for (std::size_t i = j; i < panel.rows.size(); ++i) places[i] = placeOf(target, panel.rows[i]);
    }
    for (std::size_t i = j; i < panel.rows.size(); ++i) visit(ancestor, places[i], places[j], i, j);
  }
}

/// First row of a position in a panel, −1 if it has none.
Index SelectedInverse::placeOf(const Panel& panel, int position) const {
  if (position < panel.end) return begin_[position] - begin_[panel.first];
  const auto found = std::lower_bound(panel.rows.begin(), panel.rows.end(), position);
  if (found == panel.rows.end() || *found != position) return -1;
  return panel.rowBegin[static_cast<std::size_t>(found - panel.rows.begin())];
}

std::optional<MatrixXd> SelectedInverse::find(int row, int column) const {
  const int i = std::max(position_[row], position_[column]);
  const int j = std::min(position_[row], position_[column]);
  const Panel& panel = panels_[panelOf_[j]];
  const Index place = placeOf(panel, i);
  if (place < 0) return std::nullopt;
  MatrixXd block = panel.inverse.block(place, placeOf(panel, j), size(i), size(j));
  if (anyPinned_) {
    for (Index k = 0; k < block.rows(); ++k) {
      if (isPinned_[begin_[i] + k]) block.row(k).setZero();
    }
    for (Index k = 0; k < block.cols(); ++k) {
      if (isPinned_[begin_[j] + k]) block.col(k).setZero();
    }
  }
  if (i != position_[row]) block.transposeInPlace();
  return block;
}

MatrixXd SelectedInverse::solve(const MatrixXd& b) const {
  MatrixXd x(b.rows(), b.cols());  // in the order of elimination
  const auto copyBlocks = [&](auto&& copy) {
    for (std::size_t k = 0; k < source_.size(); ++k) copy(source_[k], begin_[k], begin_[k + 1] - begin_[k]);
  };
  copyBlocks([&](Index from, Index to, Index count) { x.middleRows(to, count) = b.middleRows(from, count); });
  for (std::size_t k = 0; anyPinned_ && k < isPinned_.size(); ++k) {
    if (isPinned_[k]) x.row(static_cast<Index>(k)).setZero();
  }
  const auto gather = [&](const Panel& panel) {
    MatrixXd rows(panel.below(), x.cols());
    for (std::size_t i = 0; i < panel.rows.size(); ++i)
      rows.middleRows(panel.rowBegin[i] - panel.columns(), size(panel.rows[i])) =
          x.middleRows(begin_[panel.rows[i]], size(panel.rows[i]));
    return rows;
  };
  for (const Panel& panel : panels_) {
    auto own = x.middleRows(begin_[panel.first], panel.columns());
    panel.factor.topRows(panel.columns()).triangularView<Eigen::Lower>().solveInPlace(own);
    if (panel.below() == 0) continue;
    const MatrixXd change = panel.factor.bottomRows(panel.below()) * own;
    for (std::size_t i = 0; i < panel.rows.size(); ++i)
      x.middleRows(begin_[panel.rows[i]], size(panel.rows[i])) -=
          change.middleRows(panel.rowBegin[i] - panel.columns(), size(panel.rows[i]));
  }
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    auto own = x.middleRows(begin_[panel->first], panel->columns());
    if (panel->below() > 0) own.noalias() -= panel->factor.bottomRows(panel->below()).transpose() * gather(*panel);
    panel->factor.topRows(panel->columns()).transpose().triangularView<Eigen::Upper>().solveInPlace(own);
  }
  MatrixXd result(b.rows(), b.cols());
  copyBlocks([&](Index to, Index from, Index count) { result.middleRows(to, count) = x.middleRows(from, count); });
  return result;
}

}  // namespace quiver
