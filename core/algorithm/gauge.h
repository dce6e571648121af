#pragma once

#include <vector>

#include <quiver/core/algorithm/summary.h>
#include <quiver/core/problem/problem.h>

namespace quiver {

/// The freedom of one connected component of variables to move unnoticed.
struct ComponentGauge {
  std::vector<int> variables;
  /// Directions of the whole component that leave every error unchanged to first order.
  int free = 0;
  /// False if a vertex type on it supplies no generators and the freedom cannot be tested.
  bool tested = true;
  /// The variable of lowest id among those of largest dimension.
  int anchor = -1;
  /// What to hold so that the freedom is gone and nothing else: as many directions as are free, of the anchor and, if
  /// those do not do, of others. No minimum of the cost is lost by it: from each one the free directions lead to
  /// another of the same cost where these are as they were.
  std::vector<HeldDirections> holds;
};

/// Connected components of the variables (fixed vertices do not connect) and their free directions.
///
/// The directions are tested, not assumed: with G the generators that vertex types supply, a combination c is free
/// where ‖J G c‖ vanishes over all edges of the component. One pass over the edges at `problem.state()`.
std::vector<ComponentGauge> findGauges(const Problem& problem);

}  // namespace quiver
