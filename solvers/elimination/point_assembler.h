#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>
#include <quiver/solvers/assembly/lane_products.h>
#include <quiver/solvers/block/block_matrix.h>
#include <quiver/solvers/elimination/kernels/kernel_table.h>
#include <quiver/solvers/elimination/row_linearizer.h>

namespace quiver {

/// One linearisation, undamped: V and g of every point, and H and g of the kept vertices as if no point were there to
/// be eliminated.
///
/// Groups are cut into pieces, whose number depends on structure alone. In a piece every kept vertex it meets has one
/// record, and so has every pair of kept vertices that an edge joins; afterwards records are added in the order of
/// pieces: the same bits for any number of threads.
class PointAssembler {
 public:
  PointAssembler() = default;
  PointAssembler(const Problem& problem, const EliminationPlan& plan, const RowLinearizer& linearizer, int threads);

  /// O(edges). Allocates nothing.
  CostTotals linearize(const State& state, PhaseSeconds& seconds);
  /// The same, kept aside: what the functions below answer stays that of the last `linearize` until `takeTrial`.
  CostTotals linearizeTrial(const State& state, PhaseSeconds& seconds);
  /// What was kept aside takes the place of the last linearisation.
  void takeTrial();

  /// Sums of all points, at Group::sums.
  const double* sums() const { return sums_.data(); }
  /// As much memory again, for whoever needs it between two linearisations: a trial overwrites it.
  double* spare() { return trialSums_.data(); }
  /// H of the kept vertices: lower triangle in their own order, diagonal blocks and blocks of pairs joined by an edge.
  const BlockMatrix& hessian() const { return hessian_; }
  /// g of the kept vertices.
  std::span<const double> keptGradient() const { return keptGradient_; }
  /// g and diag(H) of all variables.
  void scatter(std::span<double> gradient, std::span<double> diagonal) const;

  std::int64_t bytes() const;

 private:
  struct Piece {
    int groupBegin;
    int groupEnd;
    std::int64_t recordBegin;
    std::int64_t recordEnd;
    CostTotals totals;
  };
  struct KindKernels {
    detail::AddPoint addPoint;
    std::vector<LaneProducts::Square> squares;
    std::vector<LaneProducts::Cross> crosses;
  };
  struct Workspace {
    RowLinearizer::Workspace rows;
    AlignedBuffer nowhere;
  };

  void cutPieces();
  void placeRecords();
  void placePairs(const EliminationPlan::Row& row, const RowKind& kind);
  void linearizePiece(const State& state, std::size_t piece, Workspace& work);
  double* startSums(const EliminationPlan::Group& group);
  void addRow(std::size_t piece, int row, int panelRow, const Panel& panel, double* sums, Workspace& work);
  void addPairs(std::size_t piece, const EliminationPlan::Row& row, const RowKind& kind, int panelRow,
                const Panel& panel, Workspace& work);
  void gatherKept(int kept);
  void gatherPairs(int column);
  void holdPoints();

  const Problem* problem_ = nullptr;
  const EliminationPlan* plan_ = nullptr;
  const RowLinearizer* linearizer_ = nullptr;
  int threads_ = 1;
  std::vector<KindKernels> kernels_;
  std::vector<Piece> pieces_;
  std::vector<std::int32_t> keptRecords_;   // by piece and kept vertex: in its piece's memory, −1 if not met
  std::vector<std::int32_t> entryRecords_;  // by piece and entry of H, for entries off the diagonal
  std::vector<std::int64_t> pairBegin_;     // of each row, where kinds with pairs exist
  std::vector<std::int32_t> pairs_;         // 2 · entry + (1 if the block is transposed), −1 if a vertex is fixed
  std::vector<Workspace> workspaces_;
  AlignedBuffer records_;
  AlignedBuffer sums_;
  BlockMatrix hessian_;
  std::vector<double> keptGradient_;
  /// The same of a trial.
  AlignedBuffer trialSums_;
  BlockMatrix trialHessian_;
  std::vector<double> trialGradient_;
};

}  // namespace quiver
