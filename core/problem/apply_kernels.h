#pragma once

#include <optional>
#include <span>
#include <vector>

#include <quiver/core/graph/robust_kernel.h>
#include <quiver/core/problem/panel.h>

namespace quiver::detail {

/// The robust kernels of a batch: none, one for all edges, or one an edge.
class BatchKernels {
 public:
  /// kernel(i) is that of edge i < count. Allocates only if they differ.
  template <typename KernelOf>
  void collect(int count, const KernelOf& kernel) {
    own_.clear();
    common_ = count > 0 ? kernel(0) : RobustKernel();
    int alike = 1;
    while (alike < count && kernel(alike) == common_) ++alike;
    if (alike >= count) return;
    own_.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) own_.push_back(kernel(i));
  }

  bool none() const { return own_.empty() && !common_; }
  bool common() const { return own_.empty(); }
  const RobustKernel& of(int edge) const { return common() ? common_ : own_[static_cast<std::size_t>(edge)]; }

 private:
  RobustKernel common_;
  std::vector<RobustKernel> own_;
};

/// Fills cost and weight from squaredError. With a correction it also turns whitened residuals and Jacobian blocks into
/// those whose products are the robust normal equations: r ← √ρ' r / (1 − α), J ← √ρ' (I − α rrᵀ/e) J. First order has
/// α = 0; second order 1 − α = √(1 + 2eρ''/ρ') (Triggs et al., Bundle adjustment, 2000), or α = 0 where that root is
/// not safely real. With a panel that is not to be weighed √ρ' is left out of both where that is possible, and weight
/// is what remains to be applied: ρ' or 1. `kernels` are those of the batch.
void applyKernels(const Panel& panel, const BatchKernels& kernels, std::span<const std::int32_t> edges, int rows,
                  std::span<const int> columns, std::optional<RobustCorrection> correction);

}  // namespace quiver::detail
