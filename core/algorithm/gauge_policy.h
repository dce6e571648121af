#pragma once

#include <vector>

#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/hold_check.h>
#include <quiver/core/algorithm/options.h>
#include <quiver/core/algorithm/summary.h>
#include <quiver/core/problem/problem.h>
#include <quiver/core/util/function_ref.h>

namespace quiver {

/// Detects the gauge of a problem at its state and, if the policy says so, holds as many directions as are free; which
/// they are. `damped` is what the automatic policy goes by: damped steps leave the gauge free. Components for which
/// `mayHold` says no keep their freedom. One pass over the edges.
std::vector<HeldSlot> settleGauge(
    Problem& problem, const Options& options, bool damped, GaugeReport& report,
    FunctionRef<bool(const ComponentGauge&)> mayHold = [](const ComponentGauge&) { return true; });

}  // namespace quiver
