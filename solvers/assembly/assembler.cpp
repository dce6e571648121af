#include <quiver/solvers/assembly/assembler.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver {
namespace {

constexpr int pieceEdges = 256;
constexpr int lanes = Panel::lanes;
/// Edges a panel call handles: few enough that the panel stays in the first cache.
constexpr int panelEdges = 16;

/// out = in (rows × columns, column-major), or its transpose.
void placeBlock(const double* in, int rows, int columns, bool transposed, double* out) {
  if (!transposed) {
    std::copy_n(in, rows * columns, out);
    return;
  }
  if (rows == 6 && columns == 6) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) out[r * 6 + c] = in[c * 6 + r];
    }
    return;
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) out[r * columns + c] = in[c * rows + r];
  }
}

}  // namespace

Assembler::Assembler(const Problem& problem, const BlockMatrix& matrix, std::vector<int> position, int threads)
    : problem_(&problem),
      plan_(problem, matrix, position),
      position_(std::move(position)),
      threads_(threads),
      set_(detectInstructionSet()),
      records_(plan_.recordNumbers() + 8, false),
      shared_(plan_.sharedNumbers() + 8, false) {
  int largest = 0;
  int largestBlock = 1;
  int largestRecord = 1;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    BatchKernels kernels{batch.uniform(), batch.largestShape(), {}, {}};
    const std::vector<int>& columns = kernels.shape.columns;
    for (std::size_t second = 0; second < columns.size(); ++second) {
      largestRecord = std::max(largestRecord, LaneProducts::squareSize(columns[second]));
      kernels.squares.push_back(LaneProducts::square(set_, kernels.shape.rows, columns[second]));
      for (std::size_t first = 0; first < second; ++first) {
        largestBlock = std::max(largestBlock, columns[first] * columns[second]);
        kernels.crosses.push_back(LaneProducts::cross(set_, kernels.shape.rows, columns[first], columns[second]));
      }
    }
    kernels_.push_back(std::move(kernels));
    largest = std::max(largest, batch.size());
    for (int begin = 0; begin < batch.size(); begin += pieceEdges) {
      pieces_.push_back({b, begin, std::min(batch.size(), begin + pieceEdges), {}});
    }
  }
  counting_.resize(static_cast<std::size_t>(largest));
  std::iota(counting_.begin(), counting_.end(), 0);
  const std::size_t tasks = threads_ == 1 ? 1 : 4 * static_cast<std::size_t>(threads_);
  nowhereSize_ = (std::max(largestBlock, largestRecord) + 7) / 8 * 8;
  workspaces_.resize(tasks);
  for (Workspace& work : workspaces_) {
    for (const BatchKernels& kernels : kernels_) work.panels.emplace_back(kernels.shape);
    work.block = AlignedBuffer((lanes + 1) * nowhereSize_);
  }
}

CostTotals Assembler::assemble(const State& state, BlockMatrix& matrix, std::span<double> gradient,
                               PhaseSeconds& seconds) {
  Stopwatch watch;
  const auto tasks = static_cast<std::int64_t>(workspaces_.size());
  const auto count = static_cast<std::int64_t>(pieces_.size());
  parallelFor(tasks, threads_, [&](std::int64_t task) {
    for (std::int64_t i = task * count / tasks; i < (task + 1) * count / tasks; ++i) {
      linearizePiece(state, matrix, pieces_[static_cast<std::size_t>(i)], workspaces_[static_cast<std::size_t>(task)]);
    }
  });
  seconds.linearize += watch.lap();
  const int variables = problem_->variables();
  constexpr int pieceVariables = 256;
  parallelFor((variables + pieceVariables - 1) / pieceVariables, threads_, [&](std::int64_t p) {
    const int end = std::min(variables, static_cast<int>(p + 1) * pieceVariables);
    for (int v = static_cast<int>(p) * pieceVariables; v < end; ++v) gatherVariable(v, matrix, gradient);
  });
  for (const AssemblyPlan::SharedBlock& block : plan_.sharedBlocks()) {
    double* out = matrix.values().data() + block.offset;
    std::copy_n(shared_.data() + plan_.sharedContribution(block.begin), block.numbers, out);
    for (std::int64_t i = block.begin + 1; i < block.end; ++i) {
      const double* in = shared_.data() + plan_.sharedContribution(i);
      for (int k = 0; k < block.numbers; ++k) out[k] += in[k];
    }
  }
  CostTotals totals;
  for (const Piece& piece : pieces_) {
    totals.chi2 += piece.totals.chi2;
    totals.cost += piece.totals.cost;
    if (totals.badBatch < 0 && piece.totals.badBatch >= 0) {
      totals.badBatch = piece.totals.badBatch;
      totals.badEdge = piece.totals.badEdge;
    }
  }
  seconds.assemble += watch.lap();
  return totals;
}

void Assembler::linearizePiece(const State& state, BlockMatrix& matrix, Piece& piece, Workspace& work) {
  const EdgeBatch& batch = problem_->batch(piece.batch);
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const Panel& panel = work.panels[static_cast<std::size_t>(piece.batch)].panel();
  const int step = kernels.uniform ? panelEdges : 1;
  piece.totals = {};
  for (int first = piece.begin; first < piece.end; first += step) {
    const int count = std::min(step, piece.end - first);
    batch.linearize(state, {counting_.data() + first, static_cast<std::size_t>(count)}, panel);
    addTotals(panel, first, count, piece);
    if (kernels.uniform) {
      if (problem_->anyHeldDirections()) dropHeldColumns(piece, first, count, panel, kernels.shape);
      writeRecords(piece, first, count, panel, kernels.shape, matrix, work);
    } else {
      const EdgeShape shape = batch.shape(first);
      if (problem_->anyHeldDirections()) dropHeldColumns(piece, first, count, panel, shape);
      writeRecords(piece, first, count, panel, shape, matrix, work);
    }
  }
}

void Assembler::addTotals(const Panel& panel, int first, int count, Piece& piece) const {
  for (int i = 0; i < count; ++i) {
    piece.totals.chi2 += panel.squaredError[i];
    piece.totals.cost += panel.cost[i];
    if (piece.totals.badBatch < 0 && !std::isfinite(panel.squaredError[i])) {
      piece.totals.badBatch = piece.batch;
      piece.totals.badEdge = first + i;
    }
  }
}

void Assembler::dropHeldColumns(const Piece& piece, int first, int count, const Panel& panel,
                                const EdgeShape& shape) const {
  for (int i = 0; i < count; ++i) {
    const auto slots = problem_->batch(piece.batch).slots(first + i);
    for (std::size_t role = 0; role < slots.size(); ++role) {
      const int variable = problem_->variableOfSlot(slots[role]);
      const std::uint64_t held = variable < 0 ? 0 : problem_->heldDirections(variable);
      if (held == 0) continue;
      const int columns = shape.columns[role];
      for (int c = 0; c < columns && c < 64; ++c) {
        if (!(held >> c & 1)) continue;
        for (int r = 0; r < shape.rows; ++r) {
          panel.jacobian[role][((i / lanes * columns + c) * shape.rows + r) * lanes + i % lanes] = 0.0;
        }
      }
    }
  }
}

void Assembler::writeRecords(const Piece& piece, int first, int count, const Panel& panel, const EdgeShape& shape,
                             BlockMatrix& matrix, Workspace& work) {
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const int roles = static_cast<int>(shape.columns.size());
  for (int group = 0; group * lanes < count; ++group) {
    const int edges = std::min(lanes, count - group * lanes);
    double* nowhere = work.block.data() + lanes * nowhereSize_;
    for (int role = 0; role < roles; ++role) {
      const int columns = shape.columns[static_cast<std::size_t>(role)];
      double* out[lanes];
      for (int i = 0; i < lanes; ++i) {
        const std::int64_t record = i < edges ? plan_.record(piece.batch, first + group * lanes + i, role) : -1;
        out[i] = record < 0 ? nowhere : records_.data() + record;
      }
      const auto square =
          kernels.uniform ? kernels.squares[static_cast<std::size_t>(role)] : LaneProducts::square(set_, 0, 0);
      square(panel.jacobian[role] + group * shape.rows * columns * lanes, panel.residual + group * shape.rows * lanes,
             shape.rows, columns, out);
    }
    if (roles > 1) writePairs(piece, first + group * lanes, edges, group, panel, shape, matrix, work);
  }
}

void Assembler::writePairs(const Piece& piece, int first, int count, int group, const Panel& panel,
                           const EdgeShape& shape, BlockMatrix& matrix, Workspace& work) {
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const int roles = static_cast<int>(shape.columns.size());
  double* out[lanes];
  for (int i = 0; i < lanes; ++i) out[i] = work.block.data() + i * nowhereSize_;
  int pair = 0;
  for (int b = 1; b < roles; ++b) {
    for (int a = 0; a < b; ++a, ++pair) {
      const int columnsA = shape.columns[static_cast<std::size_t>(a)];
      const int columnsB = shape.columns[static_cast<std::size_t>(b)];
      const auto cross =
          kernels.uniform ? kernels.crosses[static_cast<std::size_t>(pair)] : LaneProducts::cross(set_, 0, 0, 0);
      cross(panel.jacobian[a] + group * shape.rows * columnsA * lanes,
            panel.jacobian[b] + group * shape.rows * columnsB * lanes, shape.rows, columnsA, columnsB, out);
      for (int i = 0; i < count; ++i) {
        const AssemblyPlan::Destination& destination = plan_.pairs(piece.batch, first + i)[pair];
        if (destination.offset < 0) continue;
        double* target = (destination.shared ? shared_.data() : matrix.values().data()) + destination.offset;
        placeBlock(out[i], columnsA, columnsB, destination.transposed, target);
      }
    }
  }
}

void Assembler::gatherVariable(int variable, BlockMatrix& matrix, std::span<double> gradient) const {
  const int n = problem_->dimension(variable);
  double* block = matrix.block(matrix.pattern().columnBegin(position_[static_cast<std::size_t>(variable)]));
  double* g = gradient.data() + problem_->offset(variable);
  constexpr int onStack = LaneProducts::squareSize(16);
  double sum[onStack];
  const int size = LaneProducts::squareSize(n);
  const std::int64_t begin = plan_.gatherBegin(variable);
  const std::int64_t end = plan_.gatherBegin(variable + 1);
  // Larger vertices add into the first record itself, which is theirs alone.
  double* total = size <= onStack ? sum : const_cast<double*>(records_.data()) + plan_.gathered(begin);
  if (size <= onStack) std::copy_n(records_.data() + plan_.gathered(begin), size, total);
  for (std::int64_t i = begin + 1; i < end; ++i) {
    const double* record = records_.data() + plan_.gathered(i);
    for (int k = 0; k < size; ++k) total[k] += record[k];
  }
  int at = 0;
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c, ++at) block[r * n + c] = block[c * n + r] = total[at];
  }
  for (int r = 0; r < n; ++r) g[r] = total[at + r];
  const std::uint64_t held = problem_->heldDirections(variable);
  for (int r = 0; held != 0 && r < n && r < 64; ++r) {
    if (held >> r & 1) block[r * n + r] = 1.0;
  }
}

}  // namespace quiver
