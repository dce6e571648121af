#pragma once

#include <cstdint>

namespace quiver {

/// Numbers of the record of a role of that dimension D: the upper triangle of JᵀJ, row by row, then Jᵀr, and zeros up
/// to the next multiple of eight; a single number behind a multiple of eight (D = 3) is left alone.
constexpr int recordNumbers(int dimension) {
  const int numbers = dimension * (dimension + 1) / 2 + dimension;
  return numbers % 8 == 1 ? numbers : (numbers + 7) / 8 * 8;
}

/// Where a batch adds the products of its edges' whitened Jacobians, edge by edge: addresses chosen by the caller, so
/// the batch sees no matrix. Arrays have an entry for every edge of the batch and on to the next multiple of eight;
/// lanes beyond the last edge need addresses of their own that nobody reads.
struct ProductTargets {
  /// records[role][edge]: the products of the role are added here, to `recordNumbers`; edges may share a record.
  double* const* const* records = nullptr;
  /// blocks[pair][edge]: the block J_aᵀJ_b of the pair of roles a < b is written here column by column, or its
  /// transpose where flipped[pair][edge] is −1 and not 0. Pairs run (0,1), (0,2), (1,2), (0,3), …
  double* const* const* blocks = nullptr;
  const std::int64_t* const* flipped = nullptr;
};

}  // namespace quiver
