#pragma once

#include <span>
#include <string>
#include <vector>

#include <quiver/solvers/block/block_pattern.h>

namespace quiver {

/// An elimination order and its reason.
struct BlockOrdering {
  /// order[i] is the block that is eliminated i-th.
  std::vector<int> order;
  /// "amd", "metis", "natural", …
  std::string name;
};

/// The order the blocks have.
BlockOrdering naturalOrdering(int blocks);

/// Approximate minimum degree on the block graph, then a postorder of its elimination tree. Deterministic.
BlockOrdering amdOrdering(const BlockPattern& pattern);

/// Whether this build has METIS.
bool hasMetis();

/// Nested dissection by METIS with a fixed seed on the block graph, then a postorder of its elimination tree. Throws
/// LogicError in a build without METIS.
BlockOrdering metisOrdering(const BlockPattern& pattern);

/// The better of minimum degree and, where it can pay, nested dissection, by the predicted multiplications of the
/// factorisation. Dissection takes several times as long as minimum degree, so it is tried only for factorisations that
/// are long (more than 1e8 multiplications) and dense (more than 150 per scalar of L). Depends on the pattern alone.
BlockOrdering chooseOrdering(const BlockPattern& pattern);

}  // namespace quiver
