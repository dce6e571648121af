#pragma once

#include <cstdint>

namespace quiver {

/// Where a batch adds the products of its edges' whitened Jacobians, edge by edge: addresses chosen by the caller, so
/// the batch sees no matrix. Arrays have an entry for every edge of the batch and on to the next multiple of eight;
/// lanes beyond the last edge need addresses of their own that nobody reads.
struct ProductTargets {
  /// records[role][edge]: the upper triangle of JᵀJ of the role, row by row, then Jᵀr, is added here; numbers up to the
  /// next multiple of eight are touched, and edges may share a record.
  double* const* const* records = nullptr;
  /// blocks[pair][edge]: the block J_aᵀJ_b of the pair of roles a < b is written here column by column, or its
  /// transpose where flipped[pair][edge] is −1 and not 0. Pairs run (0,1), (0,2), (1,2), (0,3), …
  double* const* const* blocks = nullptr;
  const std::int64_t* const* flipped = nullptr;
};

}  // namespace quiver
