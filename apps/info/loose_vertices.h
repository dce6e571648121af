#pragma once

#include <string>
#include <vector>

#include <quiver/core/problem/problem.h>

namespace quiver::app {

/// A vertex that its edges leave free to move, were all others held.
struct LooseVertex {
  const Vertex* vertex = nullptr;
  /// In the names of its tangent.
  std::vector<std::string> directions;
};

/// By id. Looks at each vertex's own block of H: what several vertices can do only together is a matter of the gauge or
/// of the solver. O(edges) and a small eigenvalue problem a vertex.
std::vector<LooseVertex> findLooseVertices(const Problem& problem);

}  // namespace quiver::app
