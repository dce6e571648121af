#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <quiver/core/io/g2o/information_check.h>

namespace quiver::detail {
namespace {

constexpr double tolerance = 1e-6;

double largestMagnitude(std::span<const double> triangle) {
  double largest = 0.0;
  for (const double value : triangle) largest = std::max(largest, std::abs(value));
  return largest;
}

/// The whole matrix divided by `scale`, so that no product of entries overflows.
Eigen::MatrixXd scaledMatrix(std::span<const double> triangle, int dimension, double scale) {
  Eigen::MatrixXd matrix(dimension, dimension);
  std::size_t k = 0;
  for (int r = 0; r < dimension; ++r) {
    for (int c = r; c < dimension; ++c) matrix(r, c) = matrix(c, r) = triangle[k++] / scale;
  }
  return matrix;
}

/// Of the matrix divided by `scale`, where the largest cannot overflow.
EigenvalueRange scaledRange(std::span<const double> triangle, int dimension, double scale) {
  if (scale == 0.0) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaledMatrix(triangle, dimension, scale),
                                                              Eigen::EigenvaluesOnly);
  return {solver.eigenvalues()[0], solver.eigenvalues()[dimension - 1]};
}

/// Whether each diagonal entry is at least the sum of the magnitudes beside it, so that no eigenvalue is negative
/// (Gershgorin). Small matrices only; says no of others.
bool isDominant(std::span<const double> triangle, std::size_t dimension) {
  std::array<double, 8> excess{};  // of the diagonal
  if (dimension > excess.size()) return false;
  const double* value = triangle.data();
  for (std::size_t r = 0; r < dimension; ++r) {
    excess[r] += *value++;
    for (std::size_t c = r + 1; c < dimension; ++c) {
      const double magnitude = std::abs(*value++);
      excess[r] -= magnitude;
      excess[c] -= magnitude;
    }
  }
  double least = 0.0;
  for (std::size_t r = 0; r < dimension; ++r) least = std::min(least, excess[r]);
  return least == 0.0;
}

bool sameBits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

bool InformationCheck::accepts(std::span<const double> triangle, int dimension) {
  if (triangle.empty() || isDominant(triangle, static_cast<std::size_t>(dimension))) return true;
  if (sameBits(triangle, accepted_)) return true;
  if (!factorizes(triangle, dimension)) {
    const EigenvalueRange range = scaledRange(triangle, dimension, largestMagnitude(triangle));
    if (range.least < -tolerance * std::max(range.most, 0.0)) return false;
  }
  accepted_.assign(triangle.begin(), triangle.end());
  return true;
}

/// Whether Ω + ½·1e-6·max Ω_ii · I has a Cholesky factor. The largest eigenvalue is at least the largest diagonal
/// entry, so that this is sufficient (not necessary) for having no eigenvalue below −1e-6 of the largest.
bool InformationCheck::factorizes(std::span<const double> triangle, int dimension) {
  const auto n = static_cast<std::size_t>(dimension);
  factor_.assign(triangle.begin(), triangle.end());
  double largest = 0.0;
  for (std::size_t r = 0, k = 0; r < n; k += n - r, ++r) largest = std::max(largest, factor_[k]);
  if (!(largest > 0.0)) return false;
  const double shift = 0.5 * tolerance * largest;
  // Row r of the factor replaces row r of the triangle; rows below lose its outer product.
  double* row = factor_.data();
  for (std::size_t r = 0; r < n; ++r) {
    const double pivot = row[0] + shift;
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
    double* below = row + (n - r);
    for (std::size_t i = 1; i < n - r; ++i) {
      const double ratio = row[i] / pivot;
      for (std::size_t j = i; j < n - r; ++j) *below++ -= ratio * row[j];
    }
    row += n - r;
  }
  return true;
}

EigenvalueRange eigenvalueRange(std::span<const double> triangle, int dimension) {
  const double scale = largestMagnitude(triangle);
  const EigenvalueRange range = scaledRange(triangle, dimension, scale);
  return {scale * range.least, scale * range.most};
}

void clampInformation(std::span<double> triangle, int dimension) {
  const double scale = largestMagnitude(triangle);
  if (scale == 0.0) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaledMatrix(triangle, dimension, scale));
  const Eigen::MatrixXd& basis = solver.eigenvectors();
  const Eigen::VectorXd values = solver.eigenvalues().cwiseMax(0.0);
  const Eigen::MatrixXd clamped = basis * values.asDiagonal() * basis.transpose();
  std::size_t k = 0;
  for (int r = 0; r < dimension; ++r) {
    for (int c = r; c < dimension; ++c) triangle[k++] = scale * clamped(r, c);
  }
}

}  // namespace quiver::detail
