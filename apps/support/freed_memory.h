#pragma once

#include <cstdlib>

#ifdef __GLIBC__
#  include <malloc.h>
#endif

namespace quiver::app {

/// Blocks of a few megabytes come and go with the phases of a run. Freed ones are kept for the next phase instead of
/// going back to the system, which would clear every page of them anew: 3 to 6 % of a whole run.
inline void keepFreedMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 1 << 20);
#endif
}

}  // namespace quiver::app
