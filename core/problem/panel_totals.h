#pragma once

#include <quiver/core/algorithm/linear_system.h>

namespace quiver {

/// The totals of edges of one batch that are evaluated a panel after the other: in eight partial sums, so that no
/// addition waits for the one before. The same bits however the edges are cut into panels of whole groups of eight.
class PanelTotals {
 public:
  explicit PanelTotals(int batch) : batch_(batch) {}

  /// Edges first … first + count − 1 of the batch.
  void add(int first, int count, const double* squaredErrors, const double* costs);
  CostTotals sum() const;

 private:
  static constexpr int lanes = 8;
  int batch_;
  int badEdge_ = -1;
  double chi2_[lanes] = {};
  double cost_[lanes] = {};
};

}  // namespace quiver
