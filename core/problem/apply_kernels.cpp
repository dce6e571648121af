#include <quiver/core/problem/apply_kernels.h>

#include <algorithm>
#include <cmath>

#include <quiver/core/problem/lane_records.h>

namespace quiver::detail {
namespace {

constexpr std::size_t lanes = Panel::lanes;

/// The least 1 + 2eρ''/ρ' at which the second-order correction is applied. Below it the curvature along the residual is
/// (nearly) lost, or negative, and a step along it would be unbounded.
constexpr double leastCurvature = 1e-2;

/// What multiplies the edges of a panel.
struct Factors {
  alignas(64) double roots[Panel::capacity];    // √ρ'
  alignas(64) double shares[Panel::capacity];   // α/e
  alignas(64) double stretch[Panel::capacity];  // √ρ' / (1 − α)
};

/// Fills cost and weight, and ρ'' unless `second` is null.
void evaluateKernels(const Panel& panel, const BatchKernels& kernels, std::span<const std::int32_t> edges,
                     double* second) {
  if (kernels.common()) {
    kernels.of(0).evaluate({panel.squaredError, edges.size()}, {panel.cost, panel.weight, second});
    return;
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const RobustValue value = kernels.of(edges[i]).evaluate(panel.squaredError[i]);
    panel.cost[i] = value.rho;
    panel.weight[i] = value.weight;
    if (second) second[i] = value.second;
  }
}

/// Shares and stretches of the second-order correction; returns whether any edge has one.
bool curve(const Panel& panel, std::size_t count, const double* second, Factors& factors) {
  bool curved = false;
  for (std::size_t i = 0; i < count; ++i) {
    const double e = panel.squaredError[i];
    const double weight = panel.weight[i];
    factors.shares[i] = 0.0;
    factors.stretch[i] = factors.roots[i];
    if (!(weight > 0.0) || !(e > 0.0) || second[i] == 0.0) continue;
    const double curvature = 1.0 + 2.0 * e * second[i] / weight;
    if (!(curvature >= leastCurvature)) continue;
    factors.shares[i] = (1.0 - std::sqrt(curvature)) / e;
    factors.stretch[i] = factors.roots[i] / std::sqrt(curvature);
    curved = true;
  }
  return curved;
}

/// Multiplies every entry of lane values by its lane's factor.
template <typename L>
inline void scaleLanes(double* values, int entries, std::size_t groups, const double* factors) {
  for (std::size_t g = 0; g < groups; ++g, factors += lanes) {
    L factor;
    loadLanes(factors, factor);
    for (int k = 0; k < entries; ++k, values += lanes) {
      L value;
      loadLanes(values, value);
      storeLanes(value * factor, values);
    }
  }
}

/// Square roots of weights, none below zero.
template <typename L>
inline void rootLanes(const double* weights, std::size_t groups, double* roots) {
  for (std::size_t g = 0; g < groups; ++g, weights += lanes, roots += lanes) {
    L weight;
    loadLanes(weights, weight);
    storeLanes(sqrt(max(weight, L(0.0))), roots);
  }
}
QUIVER_BATCH_LOOP_AVX2 void rootLanesAvx2(const double* weights, std::size_t groups, double* roots) {
  rootLanes<Lanes<isa::Avx2>>(weights, groups, roots);
}
QUIVER_BATCH_LOOP_GENERIC void rootLanesGeneric(const double* weights, std::size_t groups, double* roots) {
  rootLanes<Lanes<isa::Generic>>(weights, groups, roots);
}

/// Blocks and residuals times a factor an edge.
template <typename L>
inline void scalePanel(const Panel& panel, std::size_t groups, int rows, std::span<const int> columns,
                       const double* blockFactors, const double* residualFactors) {
  for (std::size_t role = 0; role < columns.size(); ++role)
    scaleLanes<L>(panel.jacobian[role], rows * columns[role], groups, blockFactors);
  scaleLanes<L>(panel.residual, rows, groups, residualFactors);
}
QUIVER_BATCH_LOOP_AVX2 void scalePanelAvx2(const Panel& panel, std::size_t groups, int rows,
                                           std::span<const int> columns, const double* blockFactors,
                                           const double* residualFactors) {
  scalePanel<Lanes<isa::Avx2>>(panel, groups, rows, columns, blockFactors, residualFactors);
}
QUIVER_BATCH_LOOP_GENERIC void scalePanelGeneric(const Panel& panel, std::size_t groups, int rows,
                                                 std::span<const int> columns, const double* blockFactors,
                                                 const double* residualFactors) {
  scalePanel<Lanes<isa::Generic>>(panel, groups, rows, columns, blockFactors, residualFactors);
}

/// J ← (I − s rrᵀ) J for every lane's s, in one block.
void projectLanes(const double* residual, double* jacobian, int rows, int columns, std::size_t groups,
                  const double* shares) {
  for (std::size_t g = 0; g < groups; ++g, shares += lanes, residual += rows * Panel::lanes) {
    for (int c = 0; c < columns; ++c, jacobian += rows * Panel::lanes) {
      double along[lanes] = {};
      for (int r = 0; r < rows; ++r) {
        for (int lane = 0; lane < Panel::lanes; ++lane)
          along[lane] += residual[r * Panel::lanes + lane] * jacobian[r * Panel::lanes + lane];
      }
      for (std::size_t lane = 0; lane < lanes; ++lane) along[lane] *= shares[lane];
      for (int r = 0; r < rows; ++r) {
        for (int lane = 0; lane < Panel::lanes; ++lane)
          jacobian[r * Panel::lanes + lane] -= residual[r * Panel::lanes + lane] * along[lane];
      }
    }
  }
}

}  // namespace

void applyKernels(const Panel& panel, const BatchKernels& kernels, std::span<const std::int32_t> edges, int rows,
                  std::span<const int> columns, std::optional<RobustCorrection> correction) {
  const std::size_t count = edges.size();
  if (kernels.none()) {
    std::copy(panel.squaredError, panel.squaredError + count, panel.cost);
    std::fill(panel.weight, panel.weight + count, 1.0);
    return;
  }
  double second[Panel::capacity];
  const bool secondOrder = correction == RobustCorrection::second;
  evaluateKernels(panel, kernels, edges, secondOrder ? second : nullptr);
  if (!correction || (!secondOrder && !panel.weighed)) return;
  static const bool wide = detectInstructionSet() != InstructionSet::generic;
  const std::size_t groups = (count + lanes - 1) / lanes;
  Factors factors;
  (wide ? rootLanesAvx2 : rootLanesGeneric)(panel.weight, groups, factors.roots);
  const bool curved = secondOrder && curve(panel, count, second, factors);
  if (!curved && std::all_of(panel.weight, panel.weight + count, [](double weight) { return weight == 1.0; })) return;
  std::fill(factors.roots + count, factors.roots + groups * lanes, 1.0);
  if (curved) {
    std::fill(factors.stretch + count, factors.stretch + groups * lanes, 1.0);
    std::fill(factors.shares + count, factors.shares + groups * lanes, 0.0);
    for (std::size_t role = 0; role < columns.size(); ++role)
      projectLanes(panel.residual, panel.jacobian[role], rows, columns[role], groups, factors.shares);
  }
  (wide ? scalePanelAvx2 : scalePanelGeneric)(panel, groups, rows, columns, factors.roots,
                                              curved ? factors.stretch : factors.roots);
  if (!panel.weighed) std::fill(panel.weight, panel.weight + count, 1.0);
}

}  // namespace quiver::detail
