#pragma once

#include <optional>
#include <span>

#include <quiver/core/graph/robust_kernel.h>
#include <quiver/core/problem/panel.h>

namespace quiver::detail {

/// U upper triangular with UᵀU = Ω, row by row as Ω is given: Cholesky where Ω is definite, else the triangular factor
/// of Λ^½ Vᵀ with negative eigenvalues taken as zero. Returns whether U is diagonal. O(dimension³).
bool squareRoot(std::span<const double> information, int dimension, double* out);

/// Fills cost and weight from squaredError. With a correction it also turns whitened residuals and Jacobian blocks into
/// those whose products are the robust normal equations: r ← √ρ' r / (1 − α), J ← √ρ' (I − α rrᵀ/e) J. First order has
/// α = 0; second order 1 − α = √(1 + 2eρ''/ρ') (Triggs et al., Bundle adjustment, 2000), or α = 0 where that root is
/// not safely real. `kernels` holds one kernel an edge of the batch, or is empty.
void applyKernels(const Panel& panel, std::span<const RobustKernel> kernels, std::span<const std::int32_t> edges,
                  int rows, std::span<const int> columns, std::optional<RobustCorrection> correction);

}  // namespace quiver::detail
