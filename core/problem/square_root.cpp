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

/// The least 1 + 2eρ''/ρ' at which the second-order correction is applied. Below it the curvature along the residual is
/// (nearly) lost, or negative, and a step along it would be unbounded.
constexpr double leastCurvature = 1e-2;

/// Multiplies every entry of lane values by its lane's factor.
void scaleLanes(double* values, int entries, std::size_t groups, const double* factors) {
  for (std::size_t g = 0; g < groups; ++g, factors += Panel::lanes) {
    for (int k = 0; k < entries; ++k, values += Panel::lanes) {
      for (int lane = 0; lane < Panel::lanes; ++lane) values[lane] *= factors[lane];
    }
  }
}

/// J ← (I − s rrᵀ) J for every lane's s, in one block.
void projectLanes(const double* residual, double* jacobian, int rows, int columns, std::size_t groups,
                  const double* shares) {
  for (std::size_t g = 0; g < groups; ++g, shares += Panel::lanes, residual += rows * Panel::lanes) {
    for (int c = 0; c < columns; ++c, jacobian += rows * Panel::lanes) {
      double along[Panel::lanes] = {};
      for (int r = 0; r < rows; ++r) {
        for (int lane = 0; lane < Panel::lanes; ++lane)
          along[lane] += residual[r * Panel::lanes + lane] * jacobian[r * Panel::lanes + lane];
      }
      for (int lane = 0; lane < Panel::lanes; ++lane) along[lane] *= shares[lane];
      for (int r = 0; r < rows; ++r) {
        for (int lane = 0; lane < Panel::lanes; ++lane)
          jacobian[r * Panel::lanes + lane] -= residual[r * Panel::lanes + lane] * along[lane];
      }
    }
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
                  int rows, std::span<const int> columns, std::optional<RobustCorrection> correction) {
  const std::size_t count = edges.size();
  if (kernels.empty()) {
    std::copy(panel.squaredError, panel.squaredError + count, panel.cost);
    std::fill(panel.weight, panel.weight + count, 1.0);
    return;
  }
  double roots[Panel::capacity];    // √ρ'
  double shares[Panel::capacity];   // α/e
  double stretch[Panel::capacity];  // √ρ' / (1 − α)
  bool weighted = false;
  bool curved = false;
  for (std::size_t i = 0; i < count; ++i) {
    const double e = panel.squaredError[i];
    const RobustValue value = kernels[static_cast<std::size_t>(edges[i])].evaluate(e);
    panel.cost[i] = value.rho;
    panel.weight[i] = value.weight;
    roots[i] = stretch[i] = std::sqrt(std::max(value.weight, 0.0));
    shares[i] = 0.0;
    weighted = weighted || value.weight != 1.0;
    if (correction != RobustCorrection::second || !(value.weight > 0.0) || !(e > 0.0) || value.second == 0.0) continue;
    const double curvature = 1.0 + 2.0 * e * value.second / value.weight;
    if (!(curvature >= leastCurvature)) continue;
    shares[i] = (1.0 - std::sqrt(curvature)) / e;
    stretch[i] = roots[i] / std::sqrt(curvature);
    curved = true;
  }
  if (!correction || !(weighted || curved)) return;
  const std::size_t groups = (count + Panel::lanes - 1) / Panel::lanes;
  const std::size_t padded = groups * Panel::lanes;
  std::fill(roots + count, roots + padded, 1.0);
  std::fill(stretch + count, stretch + padded, 1.0);
  std::fill(shares + count, shares + padded, 0.0);
  for (std::size_t role = 0; role < columns.size(); ++role) {
    if (curved) projectLanes(panel.residual, panel.jacobian[role], rows, columns[role], groups, shares);
    scaleLanes(panel.jacobian[role], rows * columns[role], groups, roots);
  }
  scaleLanes(panel.residual, rows, groups, stretch);
}

}  // namespace quiver::detail
