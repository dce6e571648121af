#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/algorithm/gauge.h>
#include <Eigen/Core>

namespace quiver::detail {

/// GᵀG, G the generators of several vertices.
using GaugeProducts = Eigen::Matrix<double, gaugeDirections, gaugeDirections>;
/// Combinations of generators, a column each.
using GaugeCombinations = Eigen::Matrix<double, gaugeDirections, Eigen::Dynamic, 0, gaugeDirections, gaugeDirections>;

/// Generators lie in rows of eight numbers, of which seven count, so that innermost loops run over whole vectors.
inline constexpr int gaugeRow = 8;
static_assert(gaugeDirections <= gaugeRow);

/// ComponentGauge::holds of a component whose `free` combinations no edge notices. `generators` are those of all slots,
/// a slot's from begin[slot] on; `gram` is the component's GᵀG.
std::vector<HeldDirections> chooseHolds(const Problem& problem, const ComponentGauge& gauge, const GaugeProducts& gram,
                                        const GaugeCombinations& free, const std::vector<double>& generators,
                                        const std::vector<std::int64_t>& begin);

}  // namespace quiver::detail
