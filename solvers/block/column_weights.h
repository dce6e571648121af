#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <quiver/solvers/block/elimination_tree.h>

namespace quiver {

/// Σ weight[i] over the blocks of L below the diagonal in rows i, for every block column, without the structure of L:
/// from leaves and least common ancestors of its row subtrees (Gilbert, Ng and Peyton, An efficient algorithm to
/// compute row and column counts for sparse Cholesky factorization, 1994). `order` and `tree` belong together; weights
/// are in positions of the order. O(entries · log blocks) at worst, nearly O(entries).
std::vector<std::int64_t> columnWeights(const BlockGraph& graph, std::span<const int> order,
                                        const EliminationTree& tree, std::span<const int> weights);

}  // namespace quiver
