#include <algorithm>

#include <quiver/core/util/parallel.h>
#include <quiver/solvers/elimination/point_eliminator.h>

// The passes of PointEliminator that multiply Jacobians with vectors.

namespace quiver {
namespace {

constexpr int lanes = Panel::lanes;
constexpr int parts = 8;

}  // namespace

/// Copies the kept vertices' numbers to where lanes gather them.
void PointEliminator::padKept(std::span<const double> x, bool allVariables) {
  for (int k = 0; k < plan_->kept(); ++k) {
    const std::int64_t from = allVariables ? problem_->offset(plan_->keptVariable(k)) : plan_->keptLayout().offset(k);
    std::copy_n(x.data() + from, plan_->keptLayout().dimension(k),
                paddedIn_.data() + padded_[static_cast<std::size_t>(k)]);
  }
}

void PointEliminator::substitute(const State& state, std::span<double> delta) {
  padKept(delta, true);
  const auto groups = std::span(plan_->groups()).first(static_cast<std::size_t>(plan_->pointGroups()));
  const std::int64_t rows = groups.empty() ? 0 : groups.back().rowEnd;
  // Parts of equally many rows: groups of long tracks stand at the end.
  const auto groupAt = [&](std::int64_t row) {
    return std::lower_bound(groups.begin(), groups.end(), row,
                            [](const EliminationPlan::Group& group, std::int64_t at) { return group.rowBegin < at; }) -
           groups.begin();
  };
  parallelFor(parts, threads_, [&](std::int64_t p) {
    const auto end = p + 1 == parts ? static_cast<std::ptrdiff_t>(groups.size()) : groupAt((p + 1) * rows / parts);
    const auto begin = p == 0 ? 0 : groupAt(p * rows / parts);
    Workspace& work = workspaces_[static_cast<std::size_t>(p)];
    work.rows.end = 0;
    for (std::ptrdiff_t g = begin; g < end; ++g) {
      if (g + 1 < end) prefetchGroup(static_cast<int>(g + 1));
      substituteGroup(state, static_cast<int>(g), groups[static_cast<std::size_t>(end - 1)].rowEnd, delta, work);
    }
  });
}

/// Brings a group's gradient and factor on their way while the group before is computed.
void PointEliminator::prefetchGroup(int g) const {
  const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
  const int numbers = detail::pointNumbers(group.dimension) * lanes;
  for (int k = 0; k < numbers; k += 8) __builtin_prefetch(factorOf(g) + k);
  for (int k = numbers - group.dimension * lanes; k < numbers; k += 8)
    __builtin_prefetch(assembler_->sums() + group.sums + k);
}

/// u ← Σ J x over the kept vertices of a row.
void PointEliminator::alongRow(int r, int panelRow, const Panel& panel, double* u) const {
  const EliminationPlan::Row& row = plan_->rows()[static_cast<std::size_t>(r)];
  const RowKind& kind = plan_->kinds()[static_cast<std::size_t>(row.kind)];
  const KindKernels& kernels = kernels_[static_cast<std::size_t>(row.kind)];
  const int n = kind.shape.rows;
  std::fill_n(u, n * lanes, 0.0);
  const std::int32_t* incident = plan_->incidences().data() + row.incidences;
  for (std::size_t role = 0; role < kind.keptRoles.size(); ++role, incident += lanes) {
    const double* x[lanes];
    for (int lane = 0; lane < lanes; ++lane)
      x[lane] =
          paddedIn_.data() + padded_[static_cast<std::size_t>(incident[lane] < 0 ? plan_->kept() : incident[lane])];
    const int k = kind.dimension(static_cast<int>(role));
    kernels.multiply[role](panel.jacobian[kind.keptRoles[role]] + panelRow * n * k * lanes, x, n, k, u);
  }
}

/// δ = −(V + D)⁻¹ (g + Wᵀ δ_kept).
void PointEliminator::substituteGroup(const State& state, int g, int limit, std::span<double> delta, Workspace& work) {
  const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
  const int e = group.dimension;
  const double* factor = factorOf(g);
  double* t = work.scratch.data();
  std::copy_n(assembler_->sums() + group.sums + e * (e + 1) / 2 * lanes, e * lanes, t);
  for (int r = group.rowBegin; r < group.rowEnd && plan_->kept() > 0; ++r) {
    const auto kindIndex = static_cast<std::size_t>(plan_->rows()[static_cast<std::size_t>(r)].kind);
    const RowKind& kind = plan_->kinds()[kindIndex];
    if (kind.keptRoles.empty()) continue;
    const auto [panel, at] = linearizer_->rowPanel(state, r, limit, work.rows);
    const int n = kind.shape.rows;
    alongRow(r, at, *panel, work.along.data());
    kernels_[kindIndex].transposed(panel->jacobian[kind.role] + at * n * e * lanes, work.along.data(), n, e, t);
  }
  set_->solvePoint(e)(factor, e, t);
  for (int lane = 0; lane < lanes; ++lane) {
    if ((group.lanes >> lane & 1) == 0) continue;
    double* out = delta.data() + problem_->offset(group.points[static_cast<std::size_t>(lane)]);
    for (int j = 0; j < e; ++j) out[j] = -t[j * lanes + lane];
  }
}

/// Adds Jᵀ v to the kept vertices of a row.
void PointEliminator::scatterRow(int r, int panelRow, const Panel& panel, const double* v, double* out,
                                 Workspace& work) const {
  const EliminationPlan::Row& row = plan_->rows()[static_cast<std::size_t>(r)];
  const RowKind& kind = plan_->kinds()[static_cast<std::size_t>(row.kind)];
  const KindKernels& kernels = kernels_[static_cast<std::size_t>(row.kind)];
  const int n = kind.shape.rows;
  const std::int32_t* incident = plan_->incidences().data() + row.incidences;
  for (std::size_t role = 0; role < kind.keptRoles.size(); ++role, incident += lanes) {
    double* y[lanes];
    for (int lane = 0; lane < lanes; ++lane)
      y[lane] = incident[lane] < 0 ? work.nowhere.data() : out + padded_[static_cast<std::size_t>(incident[lane])];
    const int k = kind.dimension(static_cast<int>(role));
    kernels.scatter[role](panel.jacobian[kind.keptRoles[role]] + panelRow * n * k * lanes, v, n, k, y);
  }
}

/// What a group adds to a product. With t = Σ Jₑᵀ Jₖ x over its rows:
///   reduced    out += Σ Jₖᵀ Jₑ (V + D)⁻¹ t
///   full       y = t + V x for the points, out += Σ Jₖᵀ Jₑ x
void PointEliminator::productGroup(const State& state, int g, Product what, std::span<const double> x,
                                   std::span<double> y, double* out, Workspace& work) {
  const EliminationPlan::Group& group = plan_->groups()[static_cast<std::size_t>(g)];
  const int e = group.dimension;
  double* t = work.scratch.data();
  double* p = t + e * lanes;  // what Jₑ is multiplied with
  const double* V = assembler_->sums() + group.sums;
  std::fill_n(t, e * lanes, 0.0);
  std::fill_n(p, e * lanes, 0.0);
  if (what == Product::full) {
    for (int lane = 0; lane < lanes; ++lane) {
      if ((group.lanes >> lane & 1) == 0) continue;
      const double* own = x.data() + problem_->offset(group.points[static_cast<std::size_t>(lane)]);
      for (int j = 0; j < e; ++j) p[j * lanes + lane] = own[j];
      for (int a = 0, at = 0; a < e; ++a) {
        for (int b = a; b < e; ++b, ++at) {
          t[a * lanes + lane] += V[at * lanes + lane] * own[b];
          if (a != b) t[b * lanes + lane] += V[at * lanes + lane] * own[a];
        }
      }
    }
  }
  const auto forEachRun = [&](bool gather, bool scatter) {
    for (int begin = group.rowBegin; begin < group.rowEnd;) {
      const int end = linearizer_->runEnd(begin, group.rowEnd);
      const bool kept = begin == group.rowBegin && end == group.rowEnd && !gather;
      const auto kindIndex = static_cast<std::size_t>(plan_->rows()[static_cast<std::size_t>(begin)].kind);
      // A group of one run still has its panel from the first pass.
      const Panel& panel = kept && what == Product::reduced
                               ? work.rows.panels[kindIndex].panel()
                               : linearizer_->linearize(state, begin, end, work.rows, nullptr);
      const RowKind& kind = plan_->kinds()[kindIndex];
      const int n = kind.shape.rows;
      for (int r = begin; r < end; ++r) {
        const double* Je = panel.jacobian[kind.role] + (r - begin) * n * e * lanes;
        if (gather) {
          alongRow(r, r - begin, panel, work.along.data());
          kernels_[kindIndex].transposed(Je, work.along.data(), n, e, t);
        }
        if (scatter) {
          double* v = work.along.data();
          std::fill_n(v, n * lanes, 0.0);
          for (int c = 0; c < e; ++c) {
            for (int i = 0; i < n * lanes; ++i) v[i] += Je[c * n * lanes + i] * p[c * lanes + i % lanes];
          }
          scatterRow(r, r - begin, panel, v, out, work);
        }
      }
      begin = end;
    }
  };
  if (what == Product::reduced) {
    forEachRun(true, false);
    std::copy_n(t, e * lanes, p);
    set_->solvePoint(e)(factorOf(g), e, p);
  }
  forEachRun(what == Product::full, true);
  for (int lane = 0; what == Product::full && lane < lanes; ++lane) {
    if ((group.lanes >> lane & 1) == 0) continue;
    double* own = y.data() + problem_->offset(group.points[static_cast<std::size_t>(lane)]);
    for (int j = 0; j < e; ++j) own[j] = t[j * lanes + lane];
  }
}

/// Runs productGroup over all groups; the kept vertices' sums end in paddedOut_.front().
void PointEliminator::productPass(const State& state, Product what, std::span<const double> x, std::span<double> y) {
  if (paddedOut_.empty()) {
    for (int p = 0; p < parts; ++p) paddedOut_.emplace_back(paddedIn_.size());
  }
  const int count = plan_->pointGroups();
  parallelFor(parts, threads_, [&](std::int64_t p) {
    AlignedBuffer& out = paddedOut_[static_cast<std::size_t>(p)];
    std::fill(out.data(), out.data() + out.size(), 0.0);
    for (std::int64_t g = p * count / parts; g < (p + 1) * count / parts; ++g)
      productGroup(state, static_cast<int>(g), what, x, y, out.data(), workspaces_[static_cast<std::size_t>(p)]);
  });
  double* sum = paddedOut_.front().data();
  for (std::size_t p = 1; p < paddedOut_.size(); ++p) {
    for (std::int64_t i = 0; i < paddedIn_.size(); ++i) sum[i] += paddedOut_[p][i];
  }
}

/// y = H x over the kept vertices.
void PointEliminator::multiplyReduced(const State& state, std::span<const double> x, std::span<double> y) {
  padKept(x, false);
  productPass(state, Product::reduced, {}, {});
  assembler_->hessian().multiply(x, y);
  for (int k = 0; k < plan_->kept(); ++k) {
    const auto offset = static_cast<std::size_t>(plan_->keptLayout().offset(k));
    const double* sum = paddedOut_.front().data() + padded_[static_cast<std::size_t>(k)];
    const double* own = damping_.empty() ? nullptr : damping_.data() + problem_->offset(plan_->keptVariable(k));
    for (int c = 0; c < plan_->keptLayout().dimension(k); ++c) {
      const auto at = offset + static_cast<std::size_t>(c);
      y[at] += (own ? own[c] * x[at] : 0.0) - sum[c];
    }
  }
}

void PointEliminator::multiply(const State& state, std::span<const double> x, std::span<double> y) {
  padKept(x, true);
  productPass(state, Product::full, x, y);
  const auto scalars = static_cast<std::size_t>(plan_->keptLayout().scalars());
  std::vector<double> in(scalars);
  std::vector<double> out(scalars);
  const auto copyKept = [&](bool back) {
    for (int k = 0; k < plan_->kept(); ++k) {
      const double* sum = paddedOut_.front().data() + padded_[static_cast<std::size_t>(k)];
      for (int c = 0; c < plan_->keptLayout().dimension(k); ++c) {
        const auto own = static_cast<std::size_t>(plan_->keptLayout().offset(k) + c);
        const auto all = static_cast<std::size_t>(problem_->offset(plan_->keptVariable(k)) + c);
        if (back) {
          y[all] = out[own] + sum[c];
        } else {
          in[own] = x[all];
        }
      }
    }
  };
  copyKept(false);
  assembler_->hessian().multiply(in, out);
  copyKept(true);
}

}  // namespace quiver
