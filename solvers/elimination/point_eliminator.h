#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/solvers/block/block_matrix.h>
#include <quiver/solvers/elimination/point_assembler.h>
#include <quiver/solvers/elimination/row_linearizer.h>
#include <quiver/solvers/elimination/tile_plan.h>

namespace quiver {

/// Eliminates points from the normal equations, eight at a time, linearising again as it goes: nothing is stored for an
/// edge.
///
/// With V + D = L Lᵀ and Z = W L⁻ᵀ of a point, S = H + D − Σ Z Zᵀ and s = g − Σ Z L⁻¹ g over kept vertices. A tile's
/// records Z are written first, then every block of S that the tile touches is visited once. Blocks of a large S are
/// shared out inside the tile; a small S is copied a fixed number of times, and tiles are shared out. Either way the
/// order of all additions depends on structure alone.
class PointEliminator {
 public:
  PointEliminator() = default;
  /// `matrix` is S in elimination order, `position[kept]` a vertex's block in it. The other arguments must outlive the
  /// eliminator.
  PointEliminator(const Problem& problem, const EliminationPlan& plan, const RowLinearizer& linearizer,
                  PointAssembler& assembler, int threads);

  /// Lays out S and the lists of products. With `diagonalOnly` S has diagonal blocks alone, and the factors of points
  /// are stored for multiplyReduced.
  void layOut(const BlockMatrix& matrix, std::span<const int> position, bool diagonalOnly);

  /// Damping of what follows, in the order of variables, or empty; it must stay where it is.
  void setDamping(std::span<const double> damping);
  /// Points that V leaves undetermined in at least one direction, ascending variables.
  std::vector<int> singularPoints() const;

  /// H + D of the kept vertices, as far as the matrix has entries for it.
  void startMatrix(BlockMatrix& matrix) const;
  /// S and s at the state linearised last. Returns false if stopped.
  bool reduce(const State& state, BlockMatrix& matrix, std::span<double> right, const StopCondition& stop);
  /// The points' part of delta, from that of the kept vertices.
  void substitute(const State& state, std::span<double> delta);
  /// y = S x without S, for vectors over the kept vertices.
  void multiplyReduced(const State& state, std::span<const double> x, std::span<double> y);
  /// y = H x for vectors over all variables.
  void multiply(const State& state, std::span<const double> x, std::span<double> y);

  /// How often S is held, by the number of its values.
  static int copies(std::int64_t values);
  std::int64_t bytes() const;

 private:
  struct KindKernels {
    int e = 0;
    std::vector<detail::ReduceRow> reduce;
    std::vector<detail::MultiplyRow> multiply;
    std::vector<detail::ScatterRow> scatter;
    detail::MultiplyRow multiplyPoint = nullptr;
    detail::TransposedRow transposed = nullptr;
  };
  struct Workspace {
    RowLinearizer::Workspace rows;
    AlignedBuffer scratch;
    AlignedBuffer nowhere;
    AlignedBuffer along;   // u of a row
    AlignedBuffer factor;  // of a group's points
  };
  /// A copy of S, or S itself, and the memory of one tile.
  struct Slab {
    int tileBegin = 0;
    int tileEnd = 0;
    AlignedBuffer copy;
    std::vector<double> right;
    AlignedBuffer records;
  };
  enum class Product { reduced, full };

  void chooseKernels();
  std::vector<int> cutTiles(int most) const;
  Workspace makeWorkspace() const;
  unsigned factorGroup(int group, std::span<const double> damping, double* damped, double* factor) const;
  const double* factorOf(int group) const;
  void prefetchGroup(int group) const;
  void startReduced(BlockMatrix& matrix, std::span<double> right);
  void reduceTile(const State& state, int tile, int slabIndex, BlockMatrix& matrix, std::span<double> right);
  void writeRecords(const State& state, int group, int limit, Slab& slab, Workspace& work);
  void visitBlocks(std::int64_t begin, std::int64_t end, int e, const double* records, double* values, double* right);
  void mergeSlabs(BlockMatrix& matrix, std::span<double> right);
  void substituteGroup(const State& state, int group, int limit, std::span<double> delta, Workspace& work);
  void padKept(std::span<const double> x, bool allVariables);
  void productPass(const State& state, Product what, std::span<const double> x, std::span<double> y);
  void productGroup(const State& state, int group, Product what, std::span<const double> x, std::span<double> y,
                    double* out, Workspace& work);
  void alongRow(int row, int panelRow, const Panel& panel, double* u) const;
  void scatterRow(int row, int panelRow, const Panel& panel, const double* u, double* out, Workspace& work) const;

  const Problem* problem_ = nullptr;
  const EliminationPlan* plan_ = nullptr;
  const RowLinearizer* linearizer_ = nullptr;
  PointAssembler* assembler_ = nullptr;  // its spare memory holds the points' factors
  int threads_ = 1;
  const detail::EliminationKernels* set_ = nullptr;
  std::vector<KindKernels> kernels_;
  TilePlan tiles_;
  std::vector<int> position_;
  std::vector<std::int64_t> hessianTargets_;  // of each entry of H: 2 · offset in S + (1 if transposed); −1 if left out
  std::vector<int> classOf_;                  // of each kept vertex: its dimension's class
  std::vector<int> classDimensions_;
  std::vector<detail::SubtractPairs> pairKernels_;      // by e's class, row's, column's
  std::vector<detail::SubtractSquares> squareKernels_;  // by e's class, and the vertex's
  std::vector<int> pointDimensions_;
  std::int64_t largestRecord_ = 8;
  std::span<const double> damping_;
  std::vector<Slab> slabs_;
  std::vector<Workspace> workspaces_;
  std::vector<std::int64_t> padded_;  // of each kept vertex: its place in padded vectors
  AlignedBuffer paddedIn_;
  std::vector<AlignedBuffer> paddedOut_;  // by piece of groups
};

}  // namespace quiver
