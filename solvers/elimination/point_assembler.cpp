#include <quiver/solvers/elimination/point_assembler.h>

#include <algorithm>

#include <quiver/core/util/parallel.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/solvers/elimination/clique_pattern.h>
#include <quiver/solvers/elimination/kernels/elimination_level.h>

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
constexpr int mostPieces = 8;
constexpr std::int64_t leastRows = 64;

std::int64_t ceil8(std::int64_t n) { return (n + 7) / 8 * 8; }

}  // namespace

PointAssembler::PointAssembler(const Problem& problem, const EliminationPlan& plan, const RowLinearizer& linearizer,
                               int threads)
    : problem_(&problem), plan_(&plan), linearizer_(&linearizer), threads_(threads), sums_(plan.sumNumbers() + 8) {
  const detail::EliminationKernels& set = detail::eliminationKernels();
  const InstructionSet instructions = detectInstructionSet();
  std::int64_t largestRecord = 8;
  for (const RowKind& kind : plan.kinds()) {
    KindKernels kernels{};
    const int n = kind.shape.rows;
    if (kind.role >= 0) kernels.addPoint = set.addPoint(n, kind.shape.columns[static_cast<std::size_t>(kind.role)]);
    for (int b = 0; b < static_cast<int>(kind.keptRoles.size()); ++b) {
      kernels.squares.push_back(LaneProducts::square(instructions, n, kind.dimension(b)));
      largestRecord = std::max<std::int64_t>(largestRecord, LaneProducts::paddedSize(kind.dimension(b)));
      for (int a = 0; a < b; ++a) {
        kernels.crosses.push_back(LaneProducts::addedCross(instructions, n, kind.dimension(a), kind.dimension(b)));
        largestRecord = std::max<std::int64_t>(largestRecord, ceil8(kind.dimension(a) * kind.dimension(b)));
      }
    }
    kernels_.push_back(std::move(kernels));
  }
  hessian_ =
      BlockMatrix(std::make_shared<const BlockPattern>(BlockPattern::fromPairs(plan.keptLayout(), directPairs(plan))));
  keptGradient_.assign(static_cast<std::size_t>(plan.keptLayout().scalars()), 0.0);
  trialSums_ = AlignedBuffer(sums_.size());
  trialHessian_ = hessian_;
  trialGradient_ = keptGradient_;
  cutPieces();
  placeRecords();
  workspaces_.resize(pieces_.size());
  for (Workspace& work : workspaces_) {
    work.rows = linearizer.makeWorkspace();
    work.nowhere = AlignedBuffer(largestRecord);
  }
}

void PointAssembler::cutPieces() {
  const auto rows = static_cast<std::int64_t>(plan_->rows().size());
  const auto count = static_cast<int>(std::clamp<std::int64_t>(rows / leastRows, 1, mostPieces));
  int group = 0;
  for (int p = 0; p < count; ++p) {
    Piece piece{group, group, 0, 0, {}};
    const std::int64_t end = (p + 1) * rows / count;
    while (piece.groupEnd < static_cast<int>(plan_->groups().size()) &&
           (p + 1 == count || plan_->groups()[static_cast<std::size_t>(piece.groupEnd)].rowEnd <= end))
      ++piece.groupEnd;
    group = piece.groupEnd;
    pieces_.push_back(piece);
  }
}

void PointAssembler::placeRecords() {
  const auto kept = static_cast<std::size_t>(plan_->kept());
  const auto entries = static_cast<std::size_t>(hessian_.pattern().entries());
  const bool anyPairs = entries > kept;
  keptRecords_.assign(pieces_.size() * kept, -1);
  if (anyPairs) {
    entryRecords_.assign(pieces_.size() * entries, -1);
    pairBegin_.resize(plan_->rows().size());
  }
  std::int64_t next = 0;
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    Piece& piece = pieces_[p];
    piece.recordBegin = next;
    for (int g = piece.groupBegin; g < piece.groupEnd; ++g) {
      const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
      for (int r = group.rowBegin; r < group.rowEnd; ++r) {
        const EliminationPlan::Row& row = plan_->rows()[static_cast<std::size_t>(r)];
        const RowKind& kind = plan_->kinds()[static_cast<std::size_t>(row.kind)];
        for (std::size_t i = 0; i < kind.keptRoles.size() * lanes; ++i) {
          const std::int32_t k = plan_->incidences()[static_cast<std::size_t>(row.incidences) + i];
          if (k < 0 || keptRecords_[p * kept + static_cast<std::size_t>(k)] >= 0) continue;
          keptRecords_[p * kept + static_cast<std::size_t>(k)] = static_cast<std::int32_t>(next - piece.recordBegin);
          next += LaneProducts::paddedSize(plan_->keptLayout().dimension(k));
        }
        if (!anyPairs) continue;
        pairBegin_[static_cast<std::size_t>(r)] = static_cast<std::int64_t>(pairs_.size());
        placePairs(row, kind);
        for (std::size_t i = static_cast<std::size_t>(pairBegin_[static_cast<std::size_t>(r)]); i < pairs_.size();
             ++i) {
          if (pairs_[i] < 0) continue;
          const auto entry = static_cast<std::size_t>(pairs_[i] / 2);
          if (entryRecords_[p * entries + entry] >= 0) continue;
          entryRecords_[p * entries + entry] = static_cast<std::int32_t>(next - piece.recordBegin);
          next += ceil8(hessian_.offset(static_cast<std::int64_t>(entry) + 1) -
                        hessian_.offset(static_cast<std::int64_t>(entry)));
        }
      }
    }
    piece.recordEnd = next;
  }
  records_ = AlignedBuffer(next + 8);
}

void PointAssembler::placePairs(const EliminationPlan::Row& row, const RowKind& kind) {
  const std::int32_t* incident = plan_->incidences().data() + row.incidences;
  for (std::size_t b = 1; b < kind.keptRoles.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const int u = incident[a * lanes + lane];
        const int v = incident[b * lanes + lane];
        if (u < 0 || v < 0) {
          pairs_.push_back(-1);
        } else {
          const auto entry = hessian_.pattern().find(std::max(u, v), std::min(u, v));
          pairs_.push_back(static_cast<std::int32_t>(2 * entry + (u < v ? 1 : 0)));
        }
      }
    }
  }
}

CostTotals PointAssembler::linearizeTrial(const State& state, PhaseSeconds& seconds) {
  takeTrial();
  const CostTotals totals = linearize(state, seconds);
  takeTrial();
  return totals;
}

void PointAssembler::takeTrial() {
  std::swap(sums_, trialSums_);
  std::swap(hessian_, trialHessian_);
  std::swap(keptGradient_, trialGradient_);
}

CostTotals PointAssembler::linearize(const State& state, PhaseSeconds& seconds) {
  Stopwatch watch;
  parallelFor(static_cast<std::int64_t>(pieces_.size()), threads_, [&](std::int64_t p) {
    linearizePiece(state, static_cast<std::size_t>(p), workspaces_[static_cast<std::size_t>(p)]);
  });
  seconds.linearize += watch.lap();
  constexpr int chunk = 8;
  const int kept = plan_->kept();
  parallelFor((kept + chunk - 1) / chunk, threads_, [&](std::int64_t c) {
    const int end = std::min(kept, static_cast<int>(c + 1) * chunk);
    for (int k = static_cast<int>(c) * chunk; k < end; ++k) {
      gatherKept(k);
      gatherPairs(k);
    }
  });
  if (problem_->anyHeldDirections()) holdPoints();
  CostTotals totals;
  for (const Piece& piece : pieces_) totals.add(piece.totals);
  seconds.assemble += watch.lap();
  return totals;
}

void PointAssembler::linearizePiece(const State& state, std::size_t p, Workspace& work) {
  Piece& piece = pieces_[p];
  piece.totals = {};
  std::fill(records_.data() + piece.recordBegin, records_.data() + piece.recordEnd, 0.0);
  std::fill(work.nowhere.data(), work.nowhere.data() + work.nowhere.size(), 0.0);
  if (piece.groupBegin == piece.groupEnd) return;
  const std::vector<EliminationPlan::Group>& groups = plan_->groups();
  auto group = groups.begin() + piece.groupBegin;
  const int end = groups[static_cast<std::size_t>(piece.groupEnd - 1)].rowEnd;
  double* sums = startSums(*group);
  // Runs of rows may reach across groups.
  for (int begin = group->rowBegin; begin < end;) {
    const int runEnd = linearizer_->runEnd(begin, end);
    const Panel& panel = linearizer_->linearize(state, begin, runEnd, work.rows, &piece.totals);
    for (int r = begin; r < runEnd; ++r) {
      while (r >= group->rowEnd) sums = startSums(*++group);
      addRow(p, r, r - begin, panel, sums, work);
    }
    begin = runEnd;
  }
  while (++group != groups.begin() + piece.groupEnd) startSums(*group);
}

double* PointAssembler::startSums(const EliminationPlan::Group& group) {
  double* sums = sums_.data() + group.sums;
  std::fill_n(sums, detail::pointNumbers(group.dimension) * lanes, 0.0);
  return sums;
}

void PointAssembler::addRow(std::size_t p, int r, int panelRow, const Panel& panel, double* sums, Workspace& work) {
  const EliminationPlan::Row& row = plan_->rows()[static_cast<std::size_t>(r)];
  const RowKind& kind = plan_->kinds()[static_cast<std::size_t>(row.kind)];
  const KindKernels& kernels = kernels_[static_cast<std::size_t>(row.kind)];
  const int n = kind.shape.rows;
  const double* residual = panel.residual + panelRow * n * lanes;
  const auto blockOf = [&](int role) {
    return panel.jacobian[role] + panelRow * n * kind.shape.columns[static_cast<std::size_t>(role)] * lanes;
  };
  if (kind.role >= 0)
    kernels.addPoint(blockOf(kind.role), residual, n, kind.shape.columns[static_cast<std::size_t>(kind.role)], sums);
  const std::int32_t* records = keptRecords_.data() + p * static_cast<std::size_t>(plan_->kept());
  double* memory = records_.data() + pieces_[p].recordBegin;
  const std::int32_t* incident = plan_->incidences().data() + row.incidences;
  for (std::size_t role = 0; role < kind.keptRoles.size(); ++role, incident += lanes) {
    double* out[lanes];
    for (int lane = 0; lane < lanes; ++lane)
      out[lane] = incident[lane] < 0 ? work.nowhere.data() : memory + records[incident[lane]];
    kernels.squares[role](blockOf(kind.keptRoles[role]), residual, n, kind.dimension(static_cast<int>(role)), out);
  }
  if (kind.keptRoles.size() > 1 && !entryRecords_.empty()) addPairs(p, row, kind, panelRow, panel, work);
}

void PointAssembler::addPairs(std::size_t p, const EliminationPlan::Row& row, const RowKind& kind, int panelRow,
                              const Panel& panel, Workspace& work) {
  const KindKernels& kernels = kernels_[static_cast<std::size_t>(row.kind)];
  const int n = kind.shape.rows;
  const auto r = static_cast<std::size_t>(&row - plan_->rows().data());
  const std::int32_t* pairs = pairs_.data() + pairBegin_[r];
  const std::int32_t* records = entryRecords_.data() + p * static_cast<std::size_t>(hessian_.pattern().entries());
  double* memory = records_.data() + pieces_[p].recordBegin;
  std::size_t at = 0;
  for (int b = 1; b < static_cast<int>(kind.keptRoles.size()); ++b) {
    for (int a = 0; a < b; ++a, ++at, pairs += lanes) {
      double* out[lanes];
      std::int64_t flip[lanes];
      for (int lane = 0; lane < lanes; ++lane) {
        out[lane] = pairs[lane] < 0 ? work.nowhere.data() : memory + records[pairs[lane] / 2];
        flip[lane] = pairs[lane] >= 0 && pairs[lane] % 2 != 0 ? -1 : 0;
      }
      kernels.crosses[at](
          panel.jacobian[kind.keptRoles[static_cast<std::size_t>(a)]] + panelRow * n * kind.dimension(a) * lanes,
          panel.jacobian[kind.keptRoles[static_cast<std::size_t>(b)]] + panelRow * n * kind.dimension(b) * lanes, n,
          kind.dimension(a), kind.dimension(b), flip, out);
    }
  }
}

void PointAssembler::gatherKept(int kept) {
  const int n = plan_->keptLayout().dimension(kept);
  double* block = hessian_.block(hessian_.pattern().columnBegin(kept));
  double* g = keptGradient_.data() + plan_->keptLayout().offset(kept);
  std::fill_n(block, n * n, 0.0);
  std::fill_n(g, n, 0.0);
  for (std::size_t p = 0; p < pieces_.size(); ++p) {
    const std::int32_t at = keptRecords_[p * static_cast<std::size_t>(plan_->kept()) + static_cast<std::size_t>(kept)];
    if (at < 0) continue;
    const double* record = records_.data() + pieces_[p].recordBegin + at;
    for (int r = 0; r < n; ++r) {
      for (int c = r; c < n; ++c) block[r * n + c] += *record++;
    }
    for (int r = 0; r < n; ++r) g[r] += *record++;
  }
  for (int r = 0; r < n; ++r) {
    for (int c = r + 1; c < n; ++c) block[c * n + r] = block[r * n + c];
  }
  const std::uint64_t held = problem_->heldDirections(plan_->keptVariable(kept));
  for (int r = 0; held != 0 && r < n && r < 64; ++r) {
    if (held >> r & 1) block[r * n + r] = 1.0;
  }
}

void PointAssembler::gatherPairs(int column) {
  const BlockPattern& pattern = hessian_.pattern();
  const auto entries = static_cast<std::size_t>(pattern.entries());
  for (std::int64_t k = pattern.columnBegin(column) + 1; k < pattern.columnEnd(column); ++k) {
    double* block = hessian_.block(k);
    const std::int64_t numbers = hessian_.offset(k + 1) - hessian_.offset(k);
    std::fill_n(block, numbers, 0.0);
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      const std::int32_t at = entryRecords_[p * entries + static_cast<std::size_t>(k)];
      if (at < 0) continue;
      const double* record = records_.data() + pieces_[p].recordBegin + at;
      for (std::int64_t i = 0; i < numbers; ++i) block[i] += record[i];
    }
  }
}

void PointAssembler::holdPoints() {
  for (int g = 0; g < plan_->pointGroups(); ++g) {
    const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
    for (int lane = 0; lane < lanes; ++lane) {
      const std::int32_t point = group.points[static_cast<std::size_t>(lane)];
      const std::uint64_t held = point < 0 ? 0 : problem_->heldDirections(point);
      for (int j = 0, at = 0; held != 0 && j < group.dimension && j < 64; at += group.dimension - j, ++j) {
        if (held >> j & 1) sums_[group.sums + at * lanes + lane] = 1.0;
      }
    }
  }
}

void PointAssembler::scatter(std::span<double> gradient, std::span<double> diagonal) const {
  constexpr int chunk = 512;
  const int count = plan_->pointGroups();
  parallelFor((count + chunk - 1) / chunk, threads_, [&](std::int64_t c) {
    const int end = std::min(count, static_cast<int>(c + 1) * chunk);
    for (int g = static_cast<int>(c) * chunk; g < end; ++g) {
      const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
      const double* V = sums_.data() + group.sums;
      const double* right = V + group.dimension * (group.dimension + 1) / 2 * lanes;
      for (int lane = 0; lane < lanes; ++lane) {
        if ((group.lanes >> lane & 1) == 0) continue;
        const std::int64_t offset = problem_->offset(group.points[static_cast<std::size_t>(lane)]);
        for (int j = 0, at = 0; j < group.dimension; at += group.dimension - j, ++j) {
          gradient[static_cast<std::size_t>(offset + j)] = right[j * lanes + lane];
          diagonal[static_cast<std::size_t>(offset + j)] = V[at * lanes + lane];
        }
      }
    }
  });
  for (int k = 0; k < plan_->kept(); ++k) {
    const int n = plan_->keptLayout().dimension(k);
    const auto offset = static_cast<std::size_t>(problem_->offset(plan_->keptVariable(k)));
    const double* block = hessian_.block(hessian_.pattern().columnBegin(k));
    for (int r = 0; r < n; ++r) {
      gradient[offset + static_cast<std::size_t>(r)] =
          keptGradient_[static_cast<std::size_t>(plan_->keptLayout().offset(k) + r)];
      diagonal[offset + static_cast<std::size_t>(r)] = block[r * (n + 1)];
    }
  }
}

std::int64_t PointAssembler::bytes() const {
  const std::int64_t lists = static_cast<std::int64_t>(keptRecords_.size() + entryRecords_.size() + pairs_.size()) * 4 +
                             static_cast<std::int64_t>(pairBegin_.size()) * 8;
  return lists + (records_.size() + 2 * sums_.size()) * 8 + static_cast<std::int64_t>(hessian_.values().size()) * 16 +
         static_cast<std::int64_t>(keptGradient_.size()) * 16 +
         static_cast<std::int64_t>(workspaces_.size()) * RowLinearizer::workspaceBytes(*plan_);
}

}  // namespace quiver
