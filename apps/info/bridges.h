#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// An edge whose loss disconnects its component: no other measurement contradicts it, so its error is never seen.
struct Bridge {
  const Edge* edge = nullptr;
  /// Vertices that it holds to the largest of the parts.
  std::int64_t cutOff = 0;
};

struct Connections {
  /// Those that cut off most first, then by ids.
  std::vector<Bridge> bridges;
  /// Edges that could be taken away one after the other before a component falls apart.
  std::int64_t independentCycles = 0;
};

/// Edges that join any number of vertices count as one; fixed vertices connect like others. O(size).
Connections findBridges(const Graph& graph);

}  // namespace quiver::app
