#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>

namespace quiver {

/// What a batch knows of its edges, laid out once more in rows of eight in an order of the solver's: solvers that
/// linearise edges over and over in an order of their own stream through it, where a list of edges gathers every number
/// of every edge. Made and read by EdgeBatch alone.
struct EdgeRows {
  /// Number k of lane i in row r: constants[(r · numbers + k) · 8 + i].
  AlignedBuffer constants;
  /// Where the vertex of a role lies in a state: records[(r · arity + role) · 8 + i].
  std::vector<std::uint32_t> records;
  /// Revision of the batch that was copied.
  std::int64_t revision = -1;

  bool empty() const { return records.empty(); }
  std::int64_t bytes() const { return constants.size() * 8 + static_cast<std::int64_t>(records.size()) * 4; }
};

}  // namespace quiver
