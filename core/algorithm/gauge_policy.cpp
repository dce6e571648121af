#include <quiver/core/algorithm/gauge_policy.h>

#include <algorithm>
#include <bit>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace quiver {
namespace {

/// "3", or "3 in theta [rad]" if the vertex is held in part.
std::string describeHold(const Problem& problem, const HeldDirections& hold) {
  const int slot = problem.slotOfVariable(hold.variable);
  const int dimension = problem.dimension(hold.variable);
  const std::int64_t id = problem.vertex(slot).id();
  if (std::popcount(hold.directions) == dimension) return fmt::format("{}", id);
  const std::vector<std::string> names = problem.vertexType(slot).tangentNames(dimension);
  std::vector<std::string> held;
  for (int i = 0; i < dimension; ++i) {
    if (hold.directions >> i & 1) held.push_back(names[static_cast<std::size_t>(i)]);
  }
  return fmt::format("{} in {}", id, fmt::join(held, ", "));
}

std::string describeGauge(const GaugeReport& report, bool fixes, int found, const std::vector<std::string>& holds) {
  constexpr std::size_t most = 8;
  const std::string components = report.components == 1 ? "" : fmt::format(" in {} components", report.components);
  if (found == 0) return fmt::format("nothing is free{}", components);
  const std::string free = found == 1 ? "1 direction is free" : fmt::format("{} directions are free", found);
  if (!fixes) return fmt::format("{}{} and left so", free, components);
  if (holds.empty()) return fmt::format("{}{}; no vertex could be held", free, components);
  const auto end = holds.begin() + static_cast<std::ptrdiff_t>(std::min(most, holds.size()));
  const std::string others = holds.size() > most ? fmt::format(" and {} others", holds.size() - most) : "";
  return fmt::format("{}{}; vertex {}{} held", free, components, fmt::join(holds.begin(), end, ", "), others);
}

}  // namespace

std::vector<HeldSlot> settleGauge(Problem& problem, const Options& options, bool damped, GaugeReport& report,
                                  FunctionRef<bool(const ComponentGauge&)> mayHold) {
  const bool fixes = options.gauge == GaugePolicy::fix || (options.gauge == GaugePolicy::automatic && !damped);
  const std::vector<ComponentGauge> gauges = findGauges(problem);
  report.components = static_cast<int>(gauges.size());
  std::vector<HeldDirections> holds;
  std::vector<HeldSlot> heldSlots;
  std::vector<std::string> words;
  int found = 0;
  int held = 0;
  for (const ComponentGauge& gauge : gauges) {
    found += gauge.free;
    if (!fixes || !mayHold(gauge)) continue;
    for (const HeldDirections& hold : gauge.holds) {
      holds.push_back(hold);
      heldSlots.push_back({problem.slotOfVariable(hold.variable), hold.directions});
      held += std::popcount(hold.directions);
      words.push_back(describeHold(problem, hold));
      report.fixed.push_back(problem.vertex(problem.slotOfVariable(hold.variable)).id());
    }
  }
  report.free = found - held;
  report.reason = describeGauge(report, fixes, found, words);
  if (!holds.empty()) problem.holdDirections(holds);
  return heldSlots;
}

}  // namespace quiver
