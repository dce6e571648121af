#pragma once

namespace quiver::bench {

/// Bytes a second that `threads` cores read together from memory far larger than any cache: the best of a few passes.
double readBandwidth(int threads);

}  // namespace quiver::bench
