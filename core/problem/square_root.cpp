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

void applyKernels(const Panel& panel, std::span<const RobustKernel> kernels, std::span<const std::int32_t> edges,
                  int rows, std::span<const int> columns, bool weigh) {
  const std::size_t count = edges.size();
  if (kernels.empty()) {
    std::copy(panel.squaredError, panel.squaredError + count, panel.cost);
    std::fill(panel.weight, panel.weight + count, 1.0);
    return;
  }
  double roots[Panel::capacity];
  bool weighted = false;
  for (std::size_t i = 0; i < count; ++i) {
    const RobustValue value = kernels[static_cast<std::size_t>(edges[i])].evaluate(panel.squaredError[i]);
    panel.cost[i] = value.rho;
    panel.weight[i] = value.weight;
    roots[i] = std::sqrt(std::max(value.weight, 0.0));
    weighted = weighted || value.weight != 1.0;
  }
  if (!weigh || !weighted) return;
  const std::size_t groups = (count + Panel::lanes - 1) / Panel::lanes;
  std::fill(roots + count, roots + groups * Panel::lanes, 1.0);
  const auto scale = [&](double* values, int entries) {
    for (std::size_t g = 0; g < groups; ++g) {
      for (int k = 0; k < entries; ++k, values += Panel::lanes) {
        for (int lane = 0; lane < Panel::lanes; ++lane)
          values[lane] *= roots[g * Panel::lanes + static_cast<std::size_t>(lane)];
      }
    }
  };
  scale(panel.residual, rows);
  for (std::size_t role = 0; role < columns.size(); ++role) scale(panel.jacobian[role], rows * columns[role]);
}

}  // namespace quiver::detail
