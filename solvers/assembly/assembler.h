#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/problem/problem.h>
#include <quiver/core/util/aligned_buffer.h>
#include <quiver/solvers/assembly/assembly_plan.h>
#include <quiver/solvers/assembly/lane_products.h>
#include <quiver/solvers/assembly/product_addresses.h>
#include <quiver/solvers/block/block_matrix.h>

namespace quiver {

/// Computes H = Σ JᵀJ and g = Σ Jᵀr from the panels of a problem's edge batches, in parallel and with the same bits for
/// any number of threads: first every edge writes its records and its own blocks, then every vertex adds its records in
/// a fixed order. Batches that offer it do the first in the loop that computes the Jacobian blocks.
class Assembler {
 public:
  Assembler() = default;
  /// `position[variable]` is the block of `matrix` that belongs to the variable. The problem must outlive the
  /// assembler.
  Assembler(const Problem& problem, BlockMatrix& matrix, std::vector<int> position, int threads);

  /// Overwrites matrix, gradient and the diagonal of H (in the order of variables). Allocates nothing as long as the
  /// matrix is the one of the construction. Seconds of the two passes are added to `linearize` and `assemble`.
  CostTotals assemble(const State& state, BlockMatrix& matrix, std::span<double> gradient, std::span<double> diagonal,
                      PhaseSeconds& seconds);

  const std::vector<int>& position() const { return position_; }

 private:
  /// Kernels of a batch whose edges all have one shape.
  struct BatchKernels {
    bool uniform = false;
    EdgeShape shape;
    std::vector<LaneProducts::Square> squares;
    std::vector<LaneProducts::Cross> crosses;
  };
  using Piece = AssemblyPlan::Piece;
  /// Memory of one task: panels by batch, and where numbers of fixed vertices and of lanes beyond the last edge go.
  struct Workspace {
    std::vector<PanelBuffer> panels;
    AlignedBuffer nowhere;
  };

  void makeKernels();
  void placeAddresses(BlockMatrix& matrix);
  void findHeldPieces();
  CostTotals linearizePiece(const State& state, BlockMatrix& matrix, std::size_t index, Workspace& work);
  CostTotals multiplyPiece(const State& state, const Piece& piece);
  CostTotals spreadPanels(const State& state, BlockMatrix& matrix, const Piece& piece, Workspace& work);
  void addRecords(const Piece& piece, int first, int count, int group, const Panel& panel, const EdgeShape& shape,
                  Workspace& work);
  void writePairs(const Piece& piece, int first, int count, int group, const Panel& panel, const EdgeShape& shape,
                  BlockMatrix& matrix, Workspace& work);
  void dropHeldColumns(const Piece& piece, int first, int count, const Panel& panel, const EdgeShape& shape) const;
  void addSharedBlocks(BlockMatrix& matrix) const;

  const Problem* problem_ = nullptr;
  AssemblyPlan plan_;
  std::vector<int> position_;
  std::vector<std::int64_t> diagonalBlocks_;  // of the variables, in the matrix
  int threads_ = 1;
  InstructionSet set_ = InstructionSet::generic;
  std::vector<BatchKernels> kernels_;
  std::vector<CostTotals> totals_;  // of each piece
  std::vector<char> held_;          // of each piece: whether directions of its variables are held
  std::vector<Workspace> workspaces_;
  std::vector<std::int32_t> counting_;
  AlignedBuffer records_;
  AlignedBuffer shared_;
  /// By batch; and the matrix they point into.
  std::vector<ProductAddresses> addresses_;
  const double* placed_ = nullptr;
  /// By piece, for the product loops: see ProductAddresses.
  AlignedBuffer nowhere_;
  std::int64_t nowhereNumbers_ = 0;
};

}  // namespace quiver
