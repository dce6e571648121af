#pragma once

#include <cstdint>
#include <span>

#include <quiver/core/graph/edge.h>
#include <quiver/core/problem/batch_view.h>
#include <quiver/core/problem/edge_rows.h>

namespace quiver::detail {

/// Copies edges, a whole number of rows, from a batch whose constants lie in lanes. Leaves `rows` empty if a state is
/// too large for its 32-bit places.
void packRows(const BatchView& view, int arity, std::span<const std::int32_t> edges, EdgeRows& rows, int threads);

}  // namespace quiver::detail
