#include <quiver/apps/support/freed_memory.h>

#include <cstdint>
#include <cstdlib>  // tells __GLIBC__

#ifdef __GLIBC__
#  include <malloc.h>
#  include <sys/mman.h>
#  include <unistd.h>
#endif

namespace quiver::app {

void keepFreedMemory() {
#ifdef __GLIBC__
  constexpr int megabyte = 1 << 20;
  constexpr int reserve = 64 * megabyte;
  constexpr std::uintptr_t hugePage = 2 * megabyte;
  mallopt(M_MMAP_THRESHOLD, 1 * megabyte);
  mallopt(M_TRIM_THRESHOLD, 4 * reserve);
  // A block that does not fit makes the heap longer by the reserve: addresses alone, until they are written to.
  mallopt(M_TOP_PAD, reserve);
  void* const block = std::malloc(megabyte / 2);
  const auto end = reinterpret_cast<std::uintptr_t>(sbrk(0));
  const auto begin = (reinterpret_cast<std::uintptr_t>(block) + hugePage - 1) / hugePage * hugePage;
  std::free(block);
  mallopt(M_TOP_PAD, megabyte);
#  ifdef MADV_HUGEPAGE
  if (block != nullptr && begin < end) (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#  endif
#endif
}

}  // namespace quiver::app
