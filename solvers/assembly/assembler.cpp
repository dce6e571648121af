#include <quiver/solvers/assembly/assembler.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
/// Edges a panel call handles: few enough that the panel stays in the first cache.
constexpr int panelEdges = 16;

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
      largestRecord = std::max(largestRecord, LaneProducts::paddedSize(columns[second]));
      kernels.squares.push_back(LaneProducts::square(set_, kernels.shape.rows, columns[second]));
      for (std::size_t first = 0; first < second; ++first) {
        largestBlock = std::max(largestBlock, columns[first] * columns[second]);
        kernels.crosses.push_back(LaneProducts::cross(set_, kernels.shape.rows, columns[first], columns[second]));
      }
    }
    kernels_.push_back(std::move(kernels));
    largest = std::max(largest, batch.size());
  }
  totals_.resize(plan_.pieces().size());
  counting_.resize(static_cast<std::size_t>(largest));
  std::iota(counting_.begin(), counting_.end(), 0);
  const std::size_t tasks = threads_ == 1 ? 1 : 4 * static_cast<std::size_t>(threads_);
  workspaces_.resize(tasks);
  for (Workspace& work : workspaces_) {
    for (const BatchKernels& kernels : kernels_) work.panels.emplace_back(kernels.shape);
    work.nowhere = AlignedBuffer((std::max(largestBlock, largestRecord) + 7) / 8 * 8);
  }
}

CostTotals Assembler::assemble(const State& state, BlockMatrix& matrix, std::span<double> gradient,
                               PhaseSeconds& seconds) {
  Stopwatch watch;
  const auto tasks = static_cast<std::int64_t>(workspaces_.size());
  const auto count = static_cast<std::int64_t>(totals_.size());
  parallelFor(tasks, threads_, [&](std::int64_t task) {
    for (std::int64_t i = task * count / tasks; i < (task + 1) * count / tasks; ++i) {
      const auto at = static_cast<std::size_t>(i);
      totals_[at] = linearizePiece(state, matrix, plan_.pieces()[at], workspaces_[static_cast<std::size_t>(task)]);
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
  for (const CostTotals& piece : totals_) {
    totals.chi2 += piece.chi2;
    totals.cost += piece.cost;
    if (totals.badBatch < 0 && piece.badBatch >= 0) {
      totals.badBatch = piece.badBatch;
      totals.badEdge = piece.badEdge;
    }
  }
  seconds.assemble += watch.lap();
  return totals;
}

CostTotals Assembler::linearizePiece(const State& state, BlockMatrix& matrix, const Piece& piece, Workspace& work) {
  const EdgeBatch& batch = problem_->batch(piece.batch);
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const Panel& panel = work.panels[static_cast<std::size_t>(piece.batch)].panel();
  const int step = kernels.uniform ? panelEdges : 1;
  std::fill(records_.data() + piece.recordBegin, records_.data() + piece.recordEnd, 0.0);
  std::fill(work.nowhere.data(), work.nowhere.data() + work.nowhere.size(), 0.0);
  CostTotals totals;
  EdgeShape own;
  for (int first = piece.begin; first < piece.end; first += step) {
    const int count = std::min(step, piece.end - first);
    batch.linearize(state, {counting_.data() + first, static_cast<std::size_t>(count)}, panel);
    addTotals(piece, panel, first, count, totals);
    if (!kernels.uniform) own = batch.shape(first);
    const EdgeShape& shape = kernels.uniform ? kernels.shape : own;
    if (problem_->anyHeldDirections()) dropHeldColumns(piece, first, count, panel, shape);
    for (int group = 0; group * lanes < count; ++group) {
      const int edges = std::min(lanes, count - group * lanes);
      addRecords(piece, first + group * lanes, edges, group, panel, shape, work);
      if (shape.columns.size() > 1) writePairs(piece, first + group * lanes, edges, group, panel, shape, matrix, work);
    }
  }
  return totals;
}

void Assembler::addTotals(const Piece& piece, const Panel& panel, int first, int count, CostTotals& totals) const {
  for (int i = 0; i < count; ++i) {
    totals.chi2 += panel.squaredError[i];
    totals.cost += panel.cost[i];
    if (totals.badBatch < 0 && !std::isfinite(panel.squaredError[i])) {
      totals.badBatch = piece.batch;
      totals.badEdge = first + i;
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

void Assembler::addRecords(const Piece& piece, int first, int count, int group, const Panel& panel,
                           const EdgeShape& shape, Workspace& work) {
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const int roles = static_cast<int>(shape.columns.size());
  for (int role = 0; role < roles; ++role) {
    const int columns = shape.columns[static_cast<std::size_t>(role)];
    double* out[lanes];
    for (int i = 0; i < lanes; ++i) {
      const std::int64_t record = i < count ? plan_.record(piece.batch, first + i, role) : -1;
      out[i] = record < 0 ? work.nowhere.data() : records_.data() + record;
    }
    const auto square =
        kernels.uniform ? kernels.squares[static_cast<std::size_t>(role)] : LaneProducts::square(set_, 0, 0);
    square(panel.jacobian[role] + group * shape.rows * columns * lanes, panel.residual + group * shape.rows * lanes,
           shape.rows, columns, out);
  }
}

void Assembler::writePairs(const Piece& piece, int first, int count, int group, const Panel& panel,
                           const EdgeShape& shape, BlockMatrix& matrix, Workspace& work) {
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const int roles = static_cast<int>(shape.columns.size());
  int pair = 0;
  for (int b = 1; b < roles; ++b) {
    for (int a = 0; a < b; ++a, ++pair) {
      const int columnsA = shape.columns[static_cast<std::size_t>(a)];
      const int columnsB = shape.columns[static_cast<std::size_t>(b)];
      double* out[lanes];
      std::int64_t flip[lanes] = {};
      for (int i = 0; i < lanes; ++i) {
        out[i] = work.nowhere.data();
        if (i >= count) continue;
        const AssemblyPlan::Destination& destination = plan_.pairs(piece.batch, first + i)[pair];
        if (destination.offset < 0) continue;
        out[i] = (destination.shared ? shared_.data() : matrix.values().data()) + destination.offset;
        flip[i] = destination.transposed ? -1 : 0;
      }
      const auto cross =
          kernels.uniform ? kernels.crosses[static_cast<std::size_t>(pair)] : LaneProducts::cross(set_, 0, 0, 0);
      cross(panel.jacobian[a] + group * shape.rows * columnsA * lanes,
            panel.jacobian[b] + group * shape.rows * columnsB * lanes, shape.rows, columnsA, columnsB, flip, out);
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
