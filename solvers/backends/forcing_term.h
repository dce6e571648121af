#pragma once

#include <algorithm>

namespace quiver {

/// How exactly an iterative solver solves the systems of one descent: η, relative to the right-hand side.
///
/// Far from the optimum an exact step is wasted, so η begins loose; it follows 0.9 (‖b‖ / ‖b before‖)² down to the
/// tolerance asked for, Eisenstat and Walker's second choice ("Choosing the forcing terms in an inexact Newton method",
/// 1996), and never rises again: a right-hand side that grows comes from a step that was not exact enough.
class ForcingTerm {
 public:
  ForcingTerm() = default;
  ForcingTerm(double loosest, double tolerance) : loosest_(std::max(loosest, tolerance)), tolerance_(tolerance) {}

  /// A new descent: η is loose again.
  void restart() { before_ = 0.0; }

  /// η for the next right-hand side, by its norm.
  double next(double norm) {
    if (before_ <= 0.0) {
      eta_ = loosest_;
    } else {
      const double ratio = norm / before_;
      eta_ = std::max(tolerance_, std::min(eta_, 0.9 * ratio * ratio));
    }
    before_ = norm;
    return eta_;
  }

 private:
  double loosest_ = 0.1;
  double tolerance_ = 1e-8;
  double before_ = 0.0;
  double eta_ = 0.0;
};

}  // namespace quiver
