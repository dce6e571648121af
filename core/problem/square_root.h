#pragma once

#include <span>

#include <quiver/core/graph/robust_kernel.h>
#include <quiver/core/problem/panel.h>

namespace quiver::detail {

/// U upper triangular with UᵀU = Ω, row by row as Ω is given: Cholesky where Ω is definite, else the triangular factor
/// of Λ^½ Vᵀ with negative eigenvalues taken as zero. Returns whether U is diagonal. O(dimension³).
bool squareRoot(std::span<const double> information, int dimension, double* out);

/// Fills cost and weight from squaredError; if `weigh`, multiplies residuals and Jacobian blocks by √ρ'. `kernels`
/// holds one kernel an edge of the batch, or is empty.
void applyKernels(const Panel& panel, std::span<const RobustKernel> kernels, std::span<const std::int32_t> edges,
                  int rows, std::span<const int> columns, bool weigh);

}  // namespace quiver::detail
