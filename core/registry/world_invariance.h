#pragma once

#include <quiver/core/problem/problem.h>

namespace quiver {

/// Whether chi2 of every edge of the problem, whose edges are of one type, has no slope along a move of the world, a
/// GaugeDirection. False where a vertex type supplies no generators.
bool staysWithWorld(const Problem& problem, int direction);

}  // namespace quiver
