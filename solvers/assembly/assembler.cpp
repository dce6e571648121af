#include <quiver/solvers/assembly/assembler.h>

#include <algorithm>
#include <numeric>

#include <quiver/core/problem/panel_totals.h>
#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/solvers/assembly/diagonal_gather.h>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
/// Edges a panel call handles: few enough that the panel stays in the first cache.
constexpr int panelEdges = 16;

double linearizationNanoseconds(const Problem& problem) {
  double sum = 0.0;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    sum += batch.rowCost().linearize * batch.size() * batch.largestShape().rows;
  }
  return sum;
}

}  // namespace

Assembler::Assembler(const Problem& problem, BlockMatrix& matrix, std::vector<int> position, int threads)
    : problem_(&problem),
      plan_(problem, matrix, position),
      position_(std::move(position)),
      threads_(worthwhileThreads(threads, linearizationNanoseconds(problem))),
      set_(detectInstructionSet()),
      records_(plan_.recordNumbers() + 8, false),
      shared_(plan_.sharedNumbers() + 8, false) {
  makeKernels();
  totals_.resize(plan_.pieces().size());
  held_.resize(plan_.pieces().size(), 0);
  diagonalBlocks_.reserve(position_.size());
  for (const int place : position_) diagonalBlocks_.push_back(matrix.offset(matrix.pattern().columnBegin(place)));
  placeAddresses(matrix);
}

void Assembler::makeKernels() {
  int largest = 0;
  int largestBlock = 1;
  int largestRecord = 1;
  for (int b = 0; b < problem_->batches(); ++b) {
    const EdgeBatch& batch = problem_->batch(b);
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
  counting_.resize(static_cast<std::size_t>(largest));
  std::iota(counting_.begin(), counting_.end(), 0);
  nowhereNumbers_ = (std::max(largestBlock, largestRecord) + 7) / 8 * 8;
  workspaces_.resize(threads_ == 1 ? 1 : 4 * static_cast<std::size_t>(threads_));
  for (Workspace& work : workspaces_) {
    for (const BatchKernels& kernels : kernels_)
      work.panels.emplace_back(kernels.shape, true, kernels.uniform ? panelEdges : 1);
    work.nowhere = AlignedBuffer(nowhereNumbers_);
  }
}

void Assembler::placeAddresses(BlockMatrix& matrix) {
  nowhere_ = AlignedBuffer(nowhereNumbers_ * static_cast<std::int64_t>(plan_.pieces().size()), false);
  addresses_.clear();
  for (int b = 0; b < problem_->batches(); ++b) {
    const BatchKernels& kernels = kernels_[static_cast<std::size_t>(b)];
    const int roles = kernels.uniform ? static_cast<int>(kernels.shape.columns.size()) : 0;
    addresses_.emplace_back(*problem_, plan_, b, roles,
                            ProductAddresses::Memory{records_.data(), shared_.data(), matrix.values().data(),
                                                     nowhere_.data(), nowhereNumbers_});
  }
  placed_ = matrix.values().data();
}

CostTotals Assembler::assemble(const State& state, BlockMatrix& matrix, std::span<double> gradient,
                               std::span<double> diagonal, PhaseSeconds& seconds) {
  Stopwatch watch;
  if (matrix.values().data() != placed_) placeAddresses(matrix);
  findHeldPieces();
  const auto tasks = static_cast<std::int64_t>(workspaces_.size());
  const auto count = static_cast<std::int64_t>(totals_.size());
  parallelFor(tasks, threads_, [&](std::int64_t task) {
    for (std::int64_t i = task * count / tasks; i < (task + 1) * count / tasks; ++i) {
      const auto at = static_cast<std::size_t>(i);
      totals_[at] = linearizePiece(state, matrix, at, workspaces_[static_cast<std::size_t>(task)]);
    }
  });
  seconds.linearize += watch.lap();
  const int variables = problem_->variables();
  constexpr int pieceVariables = 512;
  const DiagonalGather gather{*problem_, plan_, diagonalBlocks_, records_.data(), matrix, gradient, diagonal};
  parallelFor((variables + pieceVariables - 1) / pieceVariables, threads_, [&](std::int64_t p) {
    const int begin = static_cast<int>(p) * pieceVariables;
    gather.run(begin, std::min(variables, begin + pieceVariables));
  });
  addSharedBlocks(matrix);
  CostTotals totals;
  for (const CostTotals& piece : totals_) totals.add(piece);
  seconds.assemble += watch.lap();
  return totals;
}

void Assembler::addSharedBlocks(BlockMatrix& matrix) const {
  for (const AssemblyPlan::SharedBlock& block : plan_.sharedBlocks()) {
    double* out = matrix.values().data() + block.offset;
    std::copy_n(shared_.data() + plan_.sharedContribution(block.begin), block.numbers, out);
    for (std::int64_t i = block.begin + 1; i < block.end; ++i) {
      const double* in = shared_.data() + plan_.sharedContribution(i);
      for (int k = 0; k < block.numbers; ++k) out[k] += in[k];
    }
  }
}

/// Pieces that have a record of a variable of which directions are held.
void Assembler::findHeldPieces() {
  std::fill(held_.begin(), held_.end(), char{0});
  if (!problem_->anyHeldDirections()) return;
  const auto& pieces = plan_.pieces();
  for (int v = 0; v < problem_->variables(); ++v) {
    if (problem_->heldDirections(v) == 0) continue;
    for (std::int64_t i = plan_.gatherBegin(v); i < plan_.gatherBegin(v + 1); ++i) {
      const auto after = std::ranges::upper_bound(pieces, plan_.gathered(i), {}, &Piece::recordBegin);
      held_[static_cast<std::size_t>(after - pieces.begin() - 1)] = 1;
    }
  }
}

CostTotals Assembler::linearizePiece(const State& state, BlockMatrix& matrix, std::size_t index, Workspace& work) {
  const Piece& piece = plan_.pieces()[index];
  if (!problem_->batch(piece.batch).addsProducts() || held_[index] != 0) {
    std::fill(records_.data() + piece.recordBegin, records_.data() + piece.recordEnd, 0.0);
    return spreadPanels(state, matrix, piece, work);
  }
  double* nowhere = nowhere_.data() + static_cast<std::int64_t>(index) * nowhereNumbers_;
  std::fill(nowhere, nowhere + nowhereNumbers_, 0.0);
  return multiplyPiece(state, piece);
}

CostTotals Assembler::multiplyPiece(const State& state, const Piece& piece) {
  const EdgeBatch& batch = problem_->batch(piece.batch);
  const ProductTargets targets = addresses_[static_cast<std::size_t>(piece.batch)].targets();
  PanelTotals totals(piece.batch);
  alignas(64) double squaredError[Panel::capacity];
  double* cleared = records_.data() + piece.recordBegin;
  for (int first = piece.begin, group = 0; first < piece.end; first += Panel::capacity, ++group) {
    const int count = std::min(Panel::capacity, piece.end - first);
    // What these edges touch first: in the first cache it is added to without being fetched again.
    double* const end = records_.data() + plan_.recordEndOf(piece, group);
    std::fill(cleared, end, 0.0);
    cleared = end;
    batch.addProducts(state, first, count, targets, squaredError);
    totals.add(first, count, squaredError, squaredError);
  }
  return totals.sum();
}

CostTotals Assembler::spreadPanels(const State& state, BlockMatrix& matrix, const Piece& piece, Workspace& work) {
  const EdgeBatch& batch = problem_->batch(piece.batch);
  const BatchKernels& kernels = kernels_[static_cast<std::size_t>(piece.batch)];
  const Panel& panel = work.panels[static_cast<std::size_t>(piece.batch)].panel();
  const int step = kernels.uniform ? panelEdges : 1;
  std::fill(work.nowhere.data(), work.nowhere.data() + work.nowhere.size(), 0.0);
  PanelTotals totals(piece.batch);
  EdgeShape own;
  for (int first = piece.begin; first < piece.end; first += step) {
    const int count = std::min(step, piece.end - first);
    batch.linearize(state, {counting_.data() + first, static_cast<std::size_t>(count)}, panel);
    totals.add(first, count, panel.squaredError, panel.cost);
    if (!kernels.uniform) own = batch.shape(first);
    const EdgeShape& shape = kernels.uniform ? kernels.shape : own;
    if (problem_->anyHeldDirections()) dropHeldColumns(piece, first, count, panel, shape);
    for (int group = 0; group * lanes < count; ++group) {
      const int edges = std::min(lanes, count - group * lanes);
      addRecords(piece, first + group * lanes, edges, group, panel, shape, work);
      if (shape.columns.size() > 1) writePairs(piece, first + group * lanes, edges, group, panel, shape, matrix, work);
    }
  }
  return totals.sum();
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

}  // namespace quiver
