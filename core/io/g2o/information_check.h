#pragma once

#include <span>
#include <vector>

namespace quiver::detail {

/// The extreme eigenvalues of a symmetric matrix.
struct EigenvalueRange {
  double least = 0.0;
  double most = 0.0;
};

/// Tells information matrices from matrices that are none: no eigenvalue below −1e-6 of the largest. A triangle is the
/// upper one, row by row, of finite numbers. Not thread safe: remembers the last matrix that was accepted, since files
/// repeat them.
class InformationCheck {
 public:
  /// Diagonal dominance decides mostly, a Cholesky factorisation nearly always, eigenvalues where neither does.
  /// O(dimension³).
  bool accepts(std::span<const double> triangle, int dimension);

 private:
  bool factorizes(std::span<const double> triangle, int dimension);

  std::vector<double> accepted_;
  std::vector<double> factor_;
};

/// O(dimension³).
EigenvalueRange eigenvalueRange(std::span<const double> triangle, int dimension);

/// Replaces negative eigenvalues by zero. O(dimension³).
void clampInformation(std::span<double> triangle, int dimension);

}  // namespace quiver::detail
