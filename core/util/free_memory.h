#pragma once

namespace quiver {

/// Gives memory that was freed but kept by the allocator back to the system, where the allocator can do that: after
/// large temporary structures. Some milliseconds where there is much of it.
void returnFreeMemory();

}  // namespace quiver
