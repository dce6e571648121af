#include <quiver/core/problem/panel_totals.h>

#include <algorithm>
#include <cmath>

namespace quiver {
namespace {

double sumOf(const double (&part)[8]) {
  return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

}  // namespace

void PanelTotals::add(int first, int count, const double* squaredErrors, const double* costs) {
  int i = 0;
  double chi2[lanes], cost[lanes];  // in registers
  std::copy_n(chi2_, lanes, chi2);
  std::copy_n(cost_, lanes, cost);
  for (; i + lanes <= count; i += lanes) {
    for (int lane = 0; lane < lanes; ++lane) {
      chi2[lane] += squaredErrors[i + lane];
      cost[lane] += costs[i + lane];
    }
  }
  for (int lane = 0; i + lane < count; ++lane) {
    chi2[lane] += squaredErrors[i + lane];
    cost[lane] += costs[i + lane];
  }
  std::copy_n(chi2, lanes, chi2_);
  std::copy_n(cost, lanes, cost_);
  double all[lanes];
  for (int lane = 0; lane < lanes; ++lane) all[lane] = chi2[lane] + cost[lane];
  // Should finite numbers add up to more than there is, no edge is found below.
  if (badEdge_ >= 0 || std::isfinite(sumOf(all))) return;
  for (int edge = 0; edge < count && badEdge_ < 0; ++edge) {
    if (!std::isfinite(squaredErrors[edge]) || !std::isfinite(costs[edge])) badEdge_ = first + edge;
  }
}

CostTotals PanelTotals::sum() const { return {sumOf(chi2_), sumOf(cost_), badEdge_ < 0 ? -1 : batch_, badEdge_}; }

}  // namespace quiver
