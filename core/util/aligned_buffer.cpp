#include <quiver/core/util/aligned_buffer.h>

#include <cstdlib>
#include <new>

#ifdef __linux__
#  include <sys/mman.h>
#endif

namespace quiver::detail {

double* allocateNumbers(std::int64_t count) {
  constexpr std::size_t line = 64, hugePage = std::size_t{2} << 20;
  const std::size_t bytes = static_cast<std::size_t>(count) * sizeof(double);
  const std::size_t alignment = bytes < hugePage ? line : hugePage;
  void* memory = nullptr;
  if (posix_memalign(&memory, alignment, bytes) != 0) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  // Advice only: whether the system takes it changes nothing but the time. The last part of a page is left out.
  if (bytes >= hugePage) (void)madvise(memory, bytes / hugePage * hugePage, MADV_HUGEPAGE);
#endif
  return static_cast<double*>(memory);
}

void freeNumbers(double* numbers) noexcept { std::free(numbers); }

}  // namespace quiver::detail
