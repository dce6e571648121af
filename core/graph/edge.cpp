#include <quiver/core/graph/edge.h>

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

/// Whether a Cholesky factor exists; small matrices, which are nearly all, cost no memory from the heap.
bool isPositiveDefinite(const Eigen::Map<const Eigen::MatrixXd>& omega) {
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
  if (omega.rows() <= 6) return Eigen::LLT<Small>(omega).info() == Eigen::Success;
  return Eigen::LLT<Eigen::MatrixXd>(omega).info() == Eigen::Success;
}

}  // namespace

void checkInformation(const double* matrix, int rows, int columns) {
  if (rows != columns)
    throw GraphError(fmt::format("information matrix: {} × {}; it must be square, one row for each number of the error",
                                 rows, columns));
  const int dimension = rows;
  const Eigen::Map<const Eigen::MatrixXd> omega(matrix, dimension, dimension);
  double largest = 0.0;
  for (int c = 0; c < dimension; ++c) {
    for (int r = 0; r < dimension; ++r) {
      if (!std::isfinite(omega(r, c))) {
        throw GraphError(fmt::format("information matrix: entry ({}, {}) is {}; every entry must be finite", r + 1,
                                     c + 1, omega(r, c)));
      }
      largest = std::max(largest, std::abs(omega(r, c)));
    }
  }
  for (int c = 0; c < dimension; ++c) {
    for (int r = 0; r < c; ++r) {
      if (std::abs(omega(r, c) - omega(c, r)) > 1e-9 * largest) {
        throw GraphError(fmt::format("information matrix: not symmetric, entries ({}, {}) and ({}, {}) are {} and {}",
                                     r + 1, c + 1, c + 1, r + 1, omega(r, c), omega(c, r)));
      }
    }
  }
  if (isPositiveDefinite(omega)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(omega, Eigen::EigenvaluesOnly);
  const double least = solver.eigenvalues()[0];
  const double most = solver.eigenvalues()[dimension - 1];
  if (least < -1e-6 * std::max(most, 0.0) || most < 0.0) {
    throw GraphError(fmt::format(
        "information matrix: not positive semi-definite, its eigenvalues reach from {:.6g} to {:.6g}", least, most));
  }
}

}  // namespace quiver
