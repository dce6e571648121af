#pragma once

#include <vector>

#include <quiver/core/algorithm/hold_check.h>
#include <quiver/core/algorithm/options.h>
#include <quiver/core/algorithm/summary.h>
#include <quiver/core/problem/problem.h>

namespace quiver {

/// Detects the gauge of a problem at its state and, if the policy says so, holds as many directions as are free; which
/// they are. `damped` is what the automatic policy goes by: damped steps leave the gauge free. One pass over the edges.
std::vector<HeldSlot> settleGauge(Problem& problem, const Options& options, bool damped, GaugeReport& report);

}  // namespace quiver
