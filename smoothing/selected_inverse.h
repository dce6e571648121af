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

  /// A coordinate that is left out of A, as if it were known, and has zeros in the inverse, since A vanishes along a
  /// direction that has 1 there. What the inverse says of blocks that no such direction moves is right all the same.
  struct Pinned {
    int block;
    int coordinate;
    /// Blocks that the direction moves, by a millionth of the most at least, each coordinate measured by the root of
    /// its entry on A's diagonal. The block itself is among them.
    std::vector<int> moved;
  };
  /// Where a pivot was no more than rounding beside its entry of A, or not a number. A pivot that is small but more is
  /// computed again, from A and a refined direction: elimination along thousands of blocks leaves more than rounding.
  const std::vector<Pinned>& pinned() const { return pinned_; }

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
  int positionOf(Eigen::Index scalar) const;
  void subtractProduct(const Panel& panel);
  void invert(Panel& panel, const StopCondition& stop) const;
  /// Calls visit(ancestor, place of row i in it, place of column j in it, i, j) for the pairs i ≥ j of the panel's
  /// rows.
  template <typename Visit>
  void forEachPair(const Panel& panel, const Visit& visit) const;
  struct Neighbour {
    int position;
    std::int64_t entry;
    bool transposed;
  };
  void listNeighbours(const BlockMatrix& matrix);
  bool pinSuspects(const BlockMatrix& matrix, const StopCondition& stop);
  void describePinned(const BlockMatrix& matrix, const StopCondition& stop);
  void multiplyRows(const BlockMatrix& matrix, int first, int last, Eigen::Index end, const Eigen::VectorXd& x,
                    Eigen::VectorXd& y) const;
  void solveLeading(Eigen::Index end, Eigen::VectorXd& x) const;
  double sumOfSizes(const BlockMatrix& matrix, int first, int last, const Eigen::VectorXd& x) const;
  double findDirection(const BlockMatrix& matrix, Eigen::Index scalar, Eigen::VectorXd& direction,
                       Eigen::VectorXd& work) const;
  Eigen::Index placeOf(const Panel& panel, int position) const;
  Eigen::Index size(int position) const { return begin_[position + 1] - begin_[position]; }

  std::vector<int> position_;         // of each block in the order of elimination
  std::vector<Eigen::Index> begin_;   // first scalar of each position; one more
  std::vector<Eigen::Index> source_;  // first scalar of each position's block in A
  std::vector<int> panelOf_;          // of each position
  std::vector<Panel> panels_;
  bool stopped_ = false;
  std::vector<int> order_;            // block at each position
  std::vector<int> firstDescendant_;  // of each position: what it depends on lies from there to it
  Eigen::VectorXd diagonal_;          // of A, in the order of elimination
  std::vector<Eigen::Index> suspects_;
  std::vector<std::vector<Neighbour>> neighbours_;  // of each position, itself first; empty while no pivot is small
  std::vector<Pinned> pinned_;
  std::vector<char> isPinned_;  // by scalar in the order of elimination
  bool anyPinned_ = false;
};

}  // namespace quiver
