#include <quiver/core/registry/world_invariance.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace quiver {

bool staysWithWorld(const Problem& problem, int direction) {
  constexpr double step = 1e-5, tolerance = 1e-6;
  State forward = problem.state(), backward = problem.state();
  double generators[64 * gaugeDirections];
  for (int slot = 0; slot < problem.slots(); ++slot) {
    const VertexType& type = problem.vertexType(slot);
    const int dimension = type.dimension(problem.vertex(slot));
    if (dimension > 64 || !type.gaugeGenerators(problem.state().record(slot), generators)) return false;
    std::vector<double> delta(static_cast<std::size_t>(dimension));
    for (int i = 0; i < dimension; ++i)
      delta[static_cast<std::size_t>(i)] = step * generators[i * gaugeDirections + direction];
    type.retract(problem.state().record(slot), delta.data(), forward.record(slot), dimension);
    for (double& part : delta) part = -part;
    type.retract(problem.state().record(slot), delta.data(), backward.record(slot), dimension);
  }
  const EdgeBatch& batch = problem.batch(0);
  PanelBuffer buffer(batch.largestShape(), false);
  for (std::int32_t edge = 0; edge < batch.size(); ++edge) {
    const std::span<const std::int32_t> list(&edge, 1);
    batch.evaluate(forward, list, buffer.panel());
    const double after = buffer.panel().squaredError[0];
    batch.evaluate(backward, list, buffer.panel());
    const double slope = (after - buffer.panel().squaredError[0]) / (2.0 * step);
    if (!(std::abs(slope) <= tolerance * std::max(1.0, after))) return false;
  }
  return true;
}

}  // namespace quiver
