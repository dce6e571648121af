#include <quiver/core/problem/square_root.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace quiver::detail {
namespace {

/// Index of entry (r, c), r ≤ c, in a row-by-row upper triangle.
int entry(int r, int c, int n) { return r * n - r * (r - 1) / 2 + c - r; }

bool isDiagonal(std::span<const double> omega, int n) {
  for (int r = 0; r < n; ++r) {
    for (int c = r + 1; c < n; ++c) {
      if (omega[static_cast<std::size_t>(entry(r, c, n))] != 0.0) return false;
    }
  }
  return true;
}

/// Right-looking Cholesky on the triangle; false when a pivot is not clearly positive.
bool cholesky(int n, double* u) {
  for (int k = 0; k < n; ++k) {
    const double original = u[entry(k, k, n)];
    double pivot = original;
    for (int i = 0; i < k; ++i) pivot -= u[entry(i, k, n)] * u[entry(i, k, n)];
    if (!(pivot > 1e-13 * original)) return false;
    const double root = std::sqrt(pivot);
    u[entry(k, k, n)] = root;
    for (int c = k + 1; c < n; ++c) {
      double value = u[entry(k, c, n)];
      for (int i = 0; i < k; ++i) value -= u[entry(i, k, n)] * u[entry(i, c, n)];
      u[entry(k, c, n)] = value / root;
    }
  }
  return true;
}

void semidefinite(std::span<const double> omega, int n, double* u) {
  Eigen::MatrixXd full(n, n);
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c) full(r, c) = full(c, r) = omega[static_cast<std::size_t>(entry(r, c, n))];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(full);
  const Eigen::VectorXd roots = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd half = roots.asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::MatrixXd triangle = Eigen::HouseholderQR<Eigen::MatrixXd>(half).matrixQR();
  for (int r = 0; r < n; ++r) {
    for (int c = r; c < n; ++c) u[entry(r, c, n)] = triangle(r, c);
  }
}

}  // namespace

bool squareRoot(std::span<const double> information, int dimension, double* out) {
  if (isDiagonal(information, dimension)) {
    std::fill(out, out + information.size(), 0.0);
    for (int r = 0; r < dimension; ++r) {
      const int k = entry(r, r, dimension);
      out[k] = std::sqrt(std::max(information[static_cast<std::size_t>(k)], 0.0));
    }
    return true;
  }
  std::copy(information.begin(), information.end(), out);
  if (!cholesky(dimension, out)) semidefinite(information, dimension, out);
  return false;
}

}  // namespace quiver::detail
