#include <quiver/core/algorithm/hold_check.h>

#include <algorithm>
#include <cmath>

namespace quiver {

HoldCheck::HoldCheck(const Problem& problem, std::span<const HeldSlot> holds) {
  if (holds.empty()) return;
  std::vector<int> holdOf(static_cast<std::size_t>(problem.slots()), -1);
  for (const HeldSlot& held : holds) {
    holdOf[static_cast<std::size_t>(held.slot)] = static_cast<int>(holds_.size());
    holds_.push_back({held.slot, held.directions, {}, {}});
  }
  buffers_.resize(static_cast<std::size_t>(problem.batches()));
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    const std::size_t before = incidences_.size();
    for (std::int32_t i = 0; i < batch.size(); ++i) {
      const auto slots = batch.slots(i);
      for (std::size_t role = 0; role < slots.size(); ++role) {
        const int hold = holdOf[static_cast<std::size_t>(slots[role])];
        if (hold < 0) continue;
        const EdgeShape shape = batch.shape(i);
        incidences_.push_back({b, i, static_cast<int>(role), shape.rows, hold});
        Hold& own = holds_[static_cast<std::size_t>(hold)];
        own.gradient.resize(static_cast<std::size_t>(shape.columns[role]));
        own.diagonal.resize(own.gradient.size());
      }
    }
    if (incidences_.size() > before) buffers_[static_cast<std::size_t>(b)] = PanelBuffer(batch.largestShape(), true, 1);
  }
}

void HoldCheck::add(const Problem& problem, const Incidence& incidence) {
  const EdgeBatch& batch = problem.batch(incidence.batch);
  const Panel& panel = buffers_[static_cast<std::size_t>(incidence.batch)].panel();
  batch.linearize(problem.state(), {&incidence.edge, 1}, panel);
  const double* J = panel.jacobian[incidence.role];
  Hold& hold = holds_[static_cast<std::size_t>(incidence.hold)];
  for (std::size_t c = 0; c < hold.gradient.size(); ++c) {
    for (int r = 0; r < incidence.rows; ++r, J += Panel::lanes) {
      hold.gradient[c] += *J * panel.residual[r * Panel::lanes];
      hold.diagonal[c] += *J * *J;
    }
  }
}

bool HoldCheck::bites(const Problem& problem, double cost, double costTolerance) {
  // Of the cost: what one held direction could lower it by. What the others have left to gain shows there too.
  const double negligible = std::max(1e-6, 1e4 * costTolerance);
  constexpr double rounding = 1e-14;  // of the estimates: how far it would go for that
  double largest = 0.0;
  for (std::int64_t i = 0; i < problem.layout().size(); ++i)
    largest = std::max(largest, std::abs(problem.state().data()[i]));
  for (Hold& hold : holds_) {
    std::fill(hold.gradient.begin(), hold.gradient.end(), 0.0);
    std::fill(hold.diagonal.begin(), hold.diagonal.end(), 0.0);
  }
  for (const Incidence& incidence : incidences_) add(problem, incidence);
  for (const Hold& hold : holds_) {
    for (std::size_t d = 0; d < hold.gradient.size() && d < 64; ++d) {
      const double g = hold.gradient[d], h = hold.diagonal[d];
      const bool own = (hold.directions >> d & 1) != 0;
      if (own && g * g > negligible * cost * h && std::abs(g) > rounding * largest * h) return true;
    }
  }
  return false;
}

}  // namespace quiver
