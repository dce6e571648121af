#include <quiver/solvers/elimination/point_eliminator.h>

#include <algorithm>
#include <atomic>

#include <quiver/core/util/parallel.h>
#include <quiver/solvers/elimination/kernels/elimination_level.h>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
/// Parts of a tile, or of a pass over all groups, that may run side by side.
constexpr int parts = 8;
/// A pivot below this share of its diagonal is rounding: the direction is left out.
constexpr double pivotFloor = 1e-13;
/// Pairs of records that are multiplied while two edges are linearised and their records written.
constexpr std::int64_t pairsPerTwoEdges = 3;
/// Copies of S for tiles that run side by side: four while S is this small, two up to the second size, else one.
constexpr std::int64_t smallMatrix = 1 << 15;
constexpr std::int64_t middleMatrix = 1 << 20;

int indexOf(std::vector<int>& list, int value) {
  const auto found = std::find(list.begin(), list.end(), value);
  if (found != list.end()) return static_cast<int>(found - list.begin());
  list.push_back(value);
  return static_cast<int>(list.size()) - 1;
}

}  // namespace

PointEliminator::PointEliminator(const Problem& problem, const EliminationPlan& plan, const RowLinearizer& linearizer,
                                 PointAssembler& assembler, int threads)
    : problem_(&problem),
      plan_(&plan),
      linearizer_(&linearizer),
      assembler_(&assembler),
      threads_(threads),
      set_(&detail::eliminationKernels()) {
  chooseKernels();
  std::int64_t next = 0;
  for (int k = 0; k < plan.kept(); ++k) {
    padded_.push_back(next);
    next += (plan.keptLayout().dimension(k) + 7) / 8 * 8;
  }
  padded_.push_back(next);  // zeros, for fixed vertices
  std::int64_t largest = 8;
  for (const RowKind& kind : plan.kinds()) {
    for (const int columns : kind.shape.columns) {
      for (const int e : pointDimensions_) largest = std::max<std::int64_t>(largest, detail::recordSize(columns, e));
      largest = std::max<std::int64_t>(largest, (columns + 7) / 8 * 8);
    }
  }
  largestRecord_ = largest;
  paddedIn_ = AlignedBuffer(next + largest);
  for (int p = 0; p < parts; ++p) workspaces_.push_back(makeWorkspace());
}

PointEliminator::Workspace PointEliminator::makeWorkspace() const {
  int scratch = 8;
  int along = 8;
  int factor = 8;
  for (const int e : pointDimensions_) {
    factor = std::max(factor, detail::pointNumbers(e) * lanes);
    for (const RowKind& kind : plan_->kinds()) scratch = std::max(scratch, std::max(kind.shape.rows, 2) * e * lanes);
  }
  for (const RowKind& kind : plan_->kinds()) along = std::max(along, kind.shape.rows * lanes);
  return {linearizer_->makeWorkspace(), AlignedBuffer(scratch), AlignedBuffer(largestRecord_), AlignedBuffer(along),
          AlignedBuffer(factor)};
}

void PointEliminator::chooseKernels() {
  for (const RowKind& kind : plan_->kinds()) {
    KindKernels kernels;
    const int n = kind.shape.rows;
    if (kind.role >= 0) {
      kernels.e = kind.shape.columns[static_cast<std::size_t>(kind.role)];
      indexOf(pointDimensions_, kernels.e);
      kernels.multiplyPoint = set_->multiplyRow(n, kernels.e);
      kernels.transposed = set_->transposedRow(n, kernels.e);
    }
    for (int role = 0; role < static_cast<int>(kind.keptRoles.size()); ++role) {
      kernels.reduce.push_back(set_->reduceRow(n, kind.dimension(role), kernels.e));
      kernels.multiply.push_back(set_->multiplyRow(n, kind.dimension(role)));
      kernels.scatter.push_back(set_->scatterRow(n, kind.dimension(role)));
    }
    kernels_.push_back(std::move(kernels));
  }
  for (int k = 0; k < plan_->kept(); ++k)
    classOf_.push_back(indexOf(classDimensions_, plan_->keptLayout().dimension(k)));
  for (const int e : pointDimensions_) {
    for (const int row : classDimensions_) {
      squareKernels_.push_back(set_->subtractSquares(row, e));
      for (const int column : classDimensions_) pairKernels_.push_back(set_->subtractPairs(row, column, e));
    }
  }
}

void PointEliminator::layOut(const BlockMatrix& matrix, std::span<const int> position, bool diagonalOnly) {
  position_.assign(position.begin(), position.end());
  tiles_ = TilePlan(*plan_, matrix, position, diagonalOnly);
  const BlockPattern& direct = assembler_->hessian().pattern();
  hessianTargets_.clear();
  for (int column = 0; column < direct.blocks(); ++column) {
    for (std::int64_t k = direct.columnBegin(column); k < direct.columnEnd(column); ++k) {
      const int r = position_[static_cast<std::size_t>(direct.row(k))];
      const int c = position_[static_cast<std::size_t>(column)];
      const std::int64_t entry = matrix.pattern().find(std::max(r, c), std::min(r, c));
      hessianTargets_.push_back(entry < 0 ? -1 : 2 * matrix.offset(entry) + (r < c ? 1 : 0));
    }
  }
  const auto size = static_cast<std::int64_t>(matrix.values().size());
  const std::vector<int> ends = cutTiles(PointEliminator::copies(size));
  slabs_.resize(ends.size());
  for (std::size_t s = 0; s < slabs_.size(); ++s) {
    Slab& slab = slabs_[s];
    slab.tileBegin = s == 0 ? 0 : ends[s - 1];
    slab.tileEnd = ends[s];
    if (s > 0) {
      slab.copy = AlignedBuffer(size);
      slab.right.assign(static_cast<std::size_t>(plan_->keptLayout().scalars()), 0.0);
    }
    slab.records = AlignedBuffer(tiles_.tileNumbers() + 8);
  }
  while (workspaces_.size() < slabs_.size() * parts) workspaces_.push_back(makeWorkspace());
}

/// Ends of at most `most` runs of tiles that take about the same time. Points of many edges come last and have many
/// pairs, so equal numbers of tiles would not do.
std::vector<int> PointEliminator::cutTiles(int most) const {
  const auto count = static_cast<int>(tiles_.tiles().size());
  std::vector<std::int64_t> work{0};
  for (const TilePlan::Tile& tile : tiles_.tiles()) {
    const std::int64_t pairs = tiles_.blocks()[static_cast<std::size_t>(tile.blockEnd)].pairs -
                               tiles_.blocks()[static_cast<std::size_t>(tile.blockBegin)].pairs;
    const std::int64_t rows = plan_->groups()[static_cast<std::size_t>(tile.groupEnd - 1)].rowEnd -
                              plan_->groups()[static_cast<std::size_t>(tile.groupBegin)].rowBegin;
    work.push_back(work.back() + 2 * pairs + rows * lanes * pairsPerTwoEdges);
  }
  std::vector<int> ends;
  for (int s = 1; s < most; ++s) {
    const std::int64_t share = work.back() * s / most;
    const auto at = std::lower_bound(work.begin(), work.end(), share);
    auto end = static_cast<int>(at - work.begin());
    // The nearer of two ends.
    if (end > 0 && share - work[static_cast<std::size_t>(end) - 1] < *at - share) --end;
    if (end > (ends.empty() ? 0 : ends.back()) && end < count) ends.push_back(end);
  }
  ends.push_back(count);
  return ends;
}

int PointEliminator::copies(std::int64_t values) { return values <= smallMatrix ? 4 : values <= middleMatrix ? 2 : 1; }

void PointEliminator::setDamping(std::span<const double> damping) {
  damping_ = damping;
  const int count = plan_->pointGroups();
  parallelFor(parts, threads_, [&](std::int64_t p) {
    Workspace& work = workspaces_[static_cast<std::size_t>(p)];
    for (auto g = static_cast<int>(p * count / parts); g < (p + 1) * count / parts; ++g) {
      const std::int64_t sums = plan_->groups()[static_cast<std::size_t>(g)].sums;
      factorGroup(g, damping_, work.scratch.data(), assembler_->spare() + sums);
    }
  });
}

/// Returns a bit for every lane whose point is left out in some direction; `damped` is memory for its damping.
unsigned PointEliminator::factorGroup(int g, std::span<const double> damping, double* damped, double* factor) const {
  const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
  std::fill_n(damped, group.dimension * lanes, 0.0);
  for (int lane = 0; lane < lanes && !damping.empty(); ++lane) {
    if ((group.lanes >> lane & 1) == 0) continue;
    const double* from = damping.data() + problem_->offset(group.points[static_cast<std::size_t>(lane)]);
    for (int j = 0; j < group.dimension; ++j) damped[j * lanes + lane] = from[j];
  }
  double dropped[lanes];
  set_->factorPoint(group.dimension)(assembler_->sums() + group.sums, damped, group.dimension, pivotFloor, factor,
                                     dropped);
  unsigned bits = 0;
  for (int lane = 0; lane < lanes; ++lane) bits |= (dropped[lane] > 0.0 ? 1U : 0U) << lane;
  return bits & group.lanes;
}

const double* PointEliminator::factorOf(int g) const {
  return assembler_->spare() + plan_->groups()[static_cast<std::size_t>(g)].sums;
}

std::vector<int> PointEliminator::singularPoints() const {
  std::vector<int> points;
  Workspace work = makeWorkspace();
  for (int g = 0; g < plan_->pointGroups(); ++g) {
    const unsigned bits = factorGroup(g, {}, work.scratch.data(), work.factor.data());
    for (std::size_t lane = 0; bits != 0 && lane < lanes; ++lane) {
      if (bits >> lane & 1) points.push_back(plan_->groups()[static_cast<std::size_t>(g)].points[lane]);
    }
  }
  std::sort(points.begin(), points.end());
  return points;
}

bool PointEliminator::reduce(const State& state, BlockMatrix& matrix, std::span<double> right,
                             const StopCondition& stop) {
  std::atomic<bool> stopped{false};
  parallelFor(static_cast<std::int64_t>(slabs_.size()), threads_, [&](std::int64_t s) {
    Slab& slab = slabs_[static_cast<std::size_t>(s)];
    if (s == 0) startReduced(matrix, right);  // only the first slab writes there
    std::fill(slab.copy.data(), slab.copy.data() + slab.copy.size(), 0.0);
    std::fill(slab.right.begin(), slab.right.end(), 0.0);
    for (int t = slab.tileBegin; t < slab.tileEnd; ++t) {
      if (stopped.load(std::memory_order_relaxed)) return;
      if (stop.reached()) stopped = true;
      reduceTile(state, t, static_cast<int>(s), matrix, right);
    }
  });
  if (stopped) return false;
  mergeSlabs(matrix, right);
  return true;
}

/// S ← H + D and s ← g of the kept vertices.
void PointEliminator::startReduced(BlockMatrix& matrix, std::span<double> right) {
  startMatrix(matrix);
  std::copy(assembler_->keptGradient().begin(), assembler_->keptGradient().end(), right.begin());
}

void PointEliminator::startMatrix(BlockMatrix& matrix) const {
  matrix.setZero();
  const BlockMatrix& hessian = assembler_->hessian();
  const BlockPattern& direct = hessian.pattern();
  for (int column = 0; column < direct.blocks(); ++column) {
    const int columns = direct.layout().dimension(column);
    for (std::int64_t k = direct.columnBegin(column); k < direct.columnEnd(column); ++k) {
      const std::int64_t target = hessianTargets_[static_cast<std::size_t>(k)];
      if (target < 0) continue;
      const int rows = direct.layout().dimension(direct.row(k));
      const double* from = hessian.block(k);
      double* to = matrix.values().data() + target / 2;
      for (int c = 0; c < columns; ++c) {
        for (int r = 0; r < rows; ++r) to[target % 2 != 0 ? r * columns + c : c * rows + r] = from[c * rows + r];
      }
    }
    if (damping_.empty()) continue;
    const int block = position_[static_cast<std::size_t>(column)];
    double* diagonal = matrix.block(matrix.pattern().columnBegin(block));
    const double* own = damping_.data() + problem_->offset(plan_->keptVariable(column));
    for (int c = 0; c < columns; ++c) diagonal[c * (columns + 1)] += own[c];
  }
}

void PointEliminator::reduceTile(const State& state, int t, int slabIndex, BlockMatrix& matrix,
                                 std::span<double> right) {
  Slab& slab = slabs_[static_cast<std::size_t>(slabIndex)];
  const TilePlan::Tile& tile = tiles_.tiles()[static_cast<std::size_t>(t)];
  const std::int64_t groups = tile.groupEnd - tile.groupBegin;
  // Slabs that run side by side leave no threads for parts; one workspace then stays in the first cache.
  const std::int64_t cuts = slabs_.size() > 1 ? 1 : parts;
  parallelFor(cuts, threads_, [&](std::int64_t p) {
    Workspace& work = workspaces_[static_cast<std::size_t>(slabIndex * parts + p)];
    const auto begin = static_cast<int>(tile.groupBegin + p * groups / cuts);
    const auto end = static_cast<int>(tile.groupBegin + (p + 1) * groups / cuts);
    work.rows.end = 0;
    for (int g = begin; g < end; ++g)
      writeRecords(state, g, plan_->groups()[static_cast<std::size_t>(end - 1)].rowEnd, slab, work);
  });
  double* values = slabIndex == 0 ? matrix.values().data() : slab.copy.data();
  double* own = slabIndex == 0 ? right.data() : slab.right.data();
  const std::int64_t blocks = tile.blockEnd - tile.blockBegin;
  parallelFor(cuts, threads_, [&](std::int64_t p) {
    visitBlocks(tile.blockBegin + p * blocks / cuts, tile.blockBegin + (p + 1) * blocks / cuts, tile.dimension,
                slab.records.data(), values, own);
  });
}

void PointEliminator::writeRecords(const State& state, int g, int limit, Slab& slab, Workspace& work) {
  const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
  const int e = group.dimension;
  const double* factor = factorOf(g);
  const double* tau = factor + e * (e + 1) / 2 * lanes;
  for (const TilePlan::SharedRecord& shared : tiles_.sharedRecords(g)) {
    const int k = plan_->keptLayout().dimension(shared.kept);
    double* record = slab.records.data() + std::int64_t{shared.place} * 8;
    std::fill_n(record, detail::recordSize(k, e), 0.0);
    for (int c = 0; c < e; ++c) record[detail::recordEntry(k, e, k, c)] = tau[c * lanes + shared.lane];
  }
  for (int r = group.rowBegin; r < group.rowEnd; ++r) {
    const auto [panel, at] = linearizer_->rowPanel(state, r, limit, work.rows);
    const EliminationPlan::Row& row = plan_->rows()[static_cast<std::size_t>(r)];
    const RowKind& kind = plan_->kinds()[static_cast<std::size_t>(row.kind)];
    const KindKernels& kernels = kernels_[static_cast<std::size_t>(row.kind)];
    const int n = kind.shape.rows;
    const double* Je = panel->jacobian[kind.role] + at * n * e * lanes;
    const std::uint16_t* places = tiles_.places(row);
    for (int role = 0; role < static_cast<int>(kind.keptRoles.size()); ++role, places += lanes) {
      const int k = kind.dimension(role);
      double* records[lanes];
      for (int lane = 0; lane < lanes; ++lane) {
        records[lane] = places[lane] == TilePlan::nowhere ? work.nowhere.data()
                                                          : slab.records.data() + std::int64_t{places[lane]} * 8;
      }
      const double* Jk = panel->jacobian[kind.keptRoles[static_cast<std::size_t>(role)]] + at * n * k * lanes;
      kernels.reduce[static_cast<std::size_t>(role)](Jk, Je, factor, n, k, e, tiles_.adds(r, role), work.scratch.data(),
                                                     records);
    }
  }
}

void PointEliminator::visitBlocks(std::int64_t begin, std::int64_t end, int e, const double* records, double* values,
                                  double* right) {
  const auto classes = classDimensions_.size();
  const auto pointClass = static_cast<std::size_t>(std::find(pointDimensions_.begin(), pointDimensions_.end(), e) -
                                                   pointDimensions_.begin());
  for (std::int64_t b = begin; b < end; ++b) {
    const TilePlan::Block& block = tiles_.blocks()[static_cast<std::size_t>(b)];
    const std::int64_t count = tiles_.blocks()[static_cast<std::size_t>(b) + 1].pairs - block.pairs;
    const detail::RecordPair* pairs = tiles_.pairs().data() + block.pairs;
    const auto row = static_cast<std::size_t>(classOf_[static_cast<std::size_t>(block.row)]);
    const auto column = static_cast<std::size_t>(classOf_[static_cast<std::size_t>(block.column)]);
    double* target = values + block.target;
    if (block.row == block.column) {
      squareKernels_[pointClass * classes + row](records, pairs, count, classDimensions_[row], e, target,
                                                 right + plan_->keptLayout().offset(block.row));
    } else {
      pairKernels_[(pointClass * classes + row) * classes + column](records, pairs, count, classDimensions_[row],
                                                                    classDimensions_[column], e, target);
    }
  }
}

void PointEliminator::mergeSlabs(BlockMatrix& matrix, std::span<double> right) {
  constexpr std::int64_t chunk = 8192;
  const auto size = static_cast<std::int64_t>(matrix.values().size());
  if (slabs_.size() == 1) return;
  parallelFor((size + chunk - 1) / chunk, threads_, [&](std::int64_t c) {
    double* values = matrix.values().data();
    for (std::size_t s = 1; s < slabs_.size(); ++s) {
      const double* copy = slabs_[s].copy.data();
      for (std::int64_t i = c * chunk; i < std::min(size, (c + 1) * chunk); ++i) values[i] += copy[i];
    }
  });
  for (std::size_t s = 1; s < slabs_.size(); ++s) {
    for (std::size_t i = 0; i < right.size(); ++i) right[i] += slabs_[s].right[i];
  }
}

std::int64_t PointEliminator::bytes() const {
  std::int64_t doubles = paddedIn_.size();
  for (const Slab& slab : slabs_)
    doubles += slab.copy.size() + slab.records.size() + static_cast<std::int64_t>(slab.right.size());
  for (const AlignedBuffer& out : paddedOut_) doubles += out.size();
  return doubles * 8 + tiles_.bytes() +
         static_cast<std::int64_t>(workspaces_.size()) * RowLinearizer::workspaceBytes(*plan_);
}

}  // namespace quiver
