#include <quiver/core/algorithm/null_space.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>

namespace quiver {
namespace {

constexpr int mostDirections = 7;
constexpr int rounds = 4;
/// ε of H + εD: far above rounding, so that the factorisation succeeds, far below what a genuine constraint is worth.
constexpr double smallDamping = 1e-10;
/// Ritz values below this are null. The factor's rounding and the iteration leave 1e-12 and less.
constexpr double nullValue = 1e-9;

using Columns = Eigen::MatrixXd;

std::span<double> column(Columns& matrix, int c) {
  return {matrix.data() + c * matrix.rows(), static_cast<std::size_t>(matrix.rows())};
}

/// Makes the columns orthonormal in vᵀDv, twice for the sake of rounding.
void orthonormalize(Columns& X, const Eigen::VectorXd& D) {
  for (int c = 0; c < X.cols(); ++c) {
    for (int repeat = 0; repeat < 2; ++repeat) {
      for (int b = 0; b < c; ++b) X.col(c) -= X.col(b) * X.col(b).dot(D.cwiseProduct(X.col(c)));
      X.col(c) /= std::sqrt(X.col(c).dot(D.cwiseProduct(X.col(c))));
    }
  }
}

}  // namespace

NullSpace findNullSpace(const Problem& problem, LinearSystem& system, const StopCondition& stop) {
  NullSpace result;
  const auto size = static_cast<Eigen::Index>(problem.scalars());
  const auto diagonal = system.diagonal();
  double largest = 0.0;
  for (const double value : diagonal) largest = std::max(largest, value);
  if (size == 0 || !std::isfinite(largest)) return result;
  Eigen::VectorXd D(size);
  for (Eigen::Index i = 0; i < size; ++i)
    D[i] = std::max({diagonal[static_cast<std::size_t>(i)], 1e-14 * largest, 1e-300});
  const Eigen::VectorXd damping = smallDamping * D;
  std::vector<double> step(static_cast<std::size_t>(size));
  if (!system.solve({damping.data(), static_cast<std::size_t>(size)}, step, stop).ok()) return result;

  std::mt19937 random(1);
  Columns X = Columns::NullaryExpr(size, std::min<Eigen::Index>(mostDirections, size), [&](Eigen::Index, Eigen::Index) {
    return static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 0.5;
  });
  for (int round = 0; round < rounds; ++round) {
    for (int c = 0; c < X.cols(); ++c) {
      X.col(c) = D.cwiseProduct(X.col(c)).eval();
      if (stop.reached() || !system.applyInverse(column(X, c))) return result;
    }
    orthonormalize(X, D);
  }
  Columns HX(X.rows(), X.cols());
  for (int c = 0; c < X.cols(); ++c) system.multiply(column(X, c), column(HX, c));
  const Eigen::MatrixXd projected = X.transpose() * HX;
  if (!projected.allFinite()) return result;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (projected + projected.transpose()));
  result.computed = true;
  for (int i = 0; i < eigen.eigenvalues().size(); ++i) {
    if (eigen.eigenvalues()[i] > nullValue) break;
    const Eigen::VectorXd direction = X * eigen.eigenvectors().col(i);
    result.directions.emplace_back(direction.data(), direction.data() + size);
  }
  return result;
}

}  // namespace quiver
