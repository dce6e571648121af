#pragma once

namespace quiver::bench {

/// Multiplications and additions a second that `threads` cores reach with nothing but fused multiply-adds in registers,
/// ×1e9: the best of a few runs of some milliseconds.
double fmaPeak(int threads);

}  // namespace quiver::bench
