#pragma once

#include <string>
#include <vector>

#include <quiver/solvers/block/block_matrix.h>

namespace quiver::bench {

/// The Hessian of a pose graph, vertex of the smallest id fixed: pattern in natural order.
struct GraphPattern {
  std::string name;
  BlockPattern pattern;
};

/// Reads nothing but the ids of binary edges ("EDGE…" lines of a .g2o file): block dimension 6 for SE3 tags, 3
/// otherwise. Throws FileError.
GraphPattern readGraphPattern(const std::string& path);

/// A walk of `poses` steps on a square grid of streets, with edges between poses that meet: like the Manhattan data
/// sets.
GraphPattern simulateManhattan(int poses);

/// Symmetric random values with a dominant diagonal; always the same.
BlockMatrix dominantValues(std::shared_ptr<const BlockPattern> pattern);

}  // namespace quiver::bench
