#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/core/problem/problem.h>

namespace quiver {

/// Directions of a slot that a gauge holds.
struct HeldSlot {
  int slot;
  std::uint64_t directions;
  bool operator==(const HeldSlot&) const = default;
};

/// Asks at an optimum whether what a gauge holds was free indeed.
class HoldCheck {
 public:
  HoldCheck() = default;
  /// Lists the edges on the held slots. O(edges).
  HoldCheck(const Problem& problem, std::span<const HeldSlot> holds);

  bool empty() const { return holds_.empty(); }
  /// Whether moving a held direction would lower the cost, at a minimum over all others: then it was no freedom, only
  /// unnoticed beside errors that changed far more where it was tested. Along a true freedom of a component the cost
  /// does not change, so the gradient there is zero. `problem` is the one of construction, its edges too. Linearises
  /// the edges on held slots; allocates nothing.
  bool bites(const Problem& problem, double cost, double costTolerance);

 private:
  struct Hold {
    int slot;
    std::uint64_t directions;
    std::vector<double> gradient;  // Jᵀr of its edges
    std::vector<double> diagonal;  // and diag(JᵀJ)
  };
  struct Incidence {
    int batch;
    std::int32_t edge;
    int role;
    int rows;
    int hold;
  };
  void add(const Problem& problem, const Incidence& incidence);

  std::vector<Hold> holds_;
  std::vector<Incidence> incidences_;
  std::vector<PanelBuffer> buffers_;  // by batch, where it has any
};

}  // namespace quiver
