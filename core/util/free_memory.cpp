#include <quiver/core/util/free_memory.h>

#include <cstdlib>

#ifdef __GLIBC__
#  include <malloc.h>
#endif

namespace quiver {

void returnFreeMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace quiver
