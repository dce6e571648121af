#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <quiver/core/algorithm/gauge_holds.h>

namespace quiver::detail {

/// Σ (J G)ᵀ(J G) over the edges of a component, and Σ over edges and roles of ‖J_role G‖² per generator, the scale of
/// the sum; and GᵀG.
struct ComponentProducts {
  std::array<double, gaugeDirections * gaugeRow> square{};
  std::array<double, gaugeRow> scale{};
  GaugeProducts gram = GaugeProducts::Zero();

  void add(const ComponentProducts& other) {
    for (std::size_t i = 0; i < square.size(); ++i) square[i] += other.square[i];
    for (std::size_t i = 0; i < scale.size(); ++i) scale[i] += other.scale[i];
  }
};

/// What addEdges reads: where each slot's generators begin, the generators, and the component of each variable.
struct GaugeSource {
  const Problem& problem;
  const std::vector<std::int64_t>& begin;
  const std::vector<double>& generators;
  const std::vector<int>& componentOf;
};

/// Adds all edges, linearised at the problem's state, to `square` and `scale` of their components. The same bits for
/// any number of threads.
void addEdges(const GaugeSource& source, std::vector<ComponentProducts>& products);

}  // namespace quiver::detail
