#pragma once

#include <quiver/solvers/cholesky/factor_plan.h>

namespace quiver::detail {

/// Finds the columns of a leaf subtree whose products outside it are taken by panels, and lists those panels. The
/// leaf's columns and their rows must be there. Returns the doubles that the largest panel takes.
std::int64_t addLeafPanels(FactorPlan& plan, int node);

}  // namespace quiver::detail
