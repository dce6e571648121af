#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <quiver/core/util/stop_condition.h>
#include <quiver/solvers/block/block_matrix.h>

namespace quiver {

/// A Cholesky factor L Lᵀ of a sparse symmetric positive definite block matrix A, and those blocks of A⁻¹ where L has
/// blocks: among them all on the diagonal and all that A has (Takahashi, Fagan and Chin, Formation of a sparse bus
/// impedance matrix, 1973; here panel by panel). Other blocks are had by solving. Blocks are numbered as those of A.
class SelectedInverse {
 public:
  SelectedInverse() = default;
  /// Orders, factors and inverts: about three times the operations of a factorisation, twice the memory of L. One
  /// thread. A may be singular: see `pinned`. Once `stop` is reached nothing more is done, and nothing may be asked but
  /// `stopped`.
  explicit SelectedInverse(const BlockMatrix& matrix, const StopCondition& stop = {});
  bool stopped() const { return stopped_; }
  /// About the bytes that the inverse of such a matrix takes. Orders it.
  static std::int64_t predictBytes(const BlockPattern& pattern);

  struct Coordinate {
    int block;
    int coordinate;
  };
  /// Where a pivot was no more than rounding beside its entry of A, or not a number: these coordinates are left out of
  /// A, as if they were known, and have zeros in the inverse. Each stands for a direction along which A vanishes; what
  /// the inverse says of blocks that none of those directions touches is right all the same.
  const std::vector<Coordinate>& pinned() const { return pinned_; }

  /// Block (row, column) of A⁻¹ if L has such a block, in either triangle. O(log rows of L's panel).
  std::optional<Eigen::MatrixXd> find(int row, int column) const;
  /// A⁻¹ b for any number of columns; what b has at coordinates left out is ignored. O(nonzeros of L) a column.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

 private:
  /// Block columns of L with the same rows below them: dense, their own rows first.
  struct Panel {
    int first = 0;  // of its columns, in the order of elimination
    int end = 0;
    std::vector<int> rows;               // below, ascending
    std::vector<Eigen::Index> rowBegin;  // first scalar of each in the panel; one more
    Eigen::MatrixXd factor;
    Eigen::MatrixXd inverse;

    Eigen::Index columns() const { return factor.cols(); }
    Eigen::Index below() const { return factor.rows() - factor.cols(); }
  };

  void layOut(const BlockMatrix& matrix, const std::vector<int>& order);
  void load(const BlockMatrix& matrix);
  void factorize(const StopCondition& stop);
  void pin(int panel, Eigen::Index column);
  void subtractProduct(const Panel& panel);
  void invert(Panel& panel, const StopCondition& stop) const;
  /// Calls visit(ancestor, place of row i in it, place of column j in it, i, j) for the pairs i ≥ j of the panel's
  /// rows.
  template <typename Visit>
  void forEachPair(const Panel& panel, const Visit& visit) const;
  Eigen::Index placeOf(const Panel& panel, int position) const;
  Eigen::Index size(int position) const { return begin_[position + 1] - begin_[position]; }

  std::vector<int> position_;         // of each block in the order of elimination
  std::vector<Eigen::Index> begin_;   // first scalar of each position; one more
  std::vector<Eigen::Index> source_;  // first scalar of each position's block in A
  std::vector<int> panelOf_;          // of each position
  std::vector<Panel> panels_;
  bool stopped_ = false;
  std::vector<Coordinate> pinned_;
  std::vector<char> isPinned_;  // by scalar in the order of elimination, empty if none is
};

}  // namespace quiver
