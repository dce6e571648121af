#pragma once

#include <span>

namespace quiver::detail {

/// U upper triangular with UᵀU = Ω, row by row as Ω is given: Cholesky where Ω is definite, else the triangular factor
/// of Λ^½ Vᵀ with negative eigenvalues taken as zero. Returns whether U is diagonal. O(dimension³).
bool squareRoot(std::span<const double> information, int dimension, double* out);

}  // namespace quiver::detail
