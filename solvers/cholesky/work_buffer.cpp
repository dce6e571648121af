#include <quiver/solvers/cholesky/work_buffer.h>

#if defined(__linux__)
#  include <sys/mman.h>
#endif

namespace quiver::detail {
namespace {

constexpr std::int64_t largePage = std::int64_t{2} << 20;

/// A request, not a need: where it fails, small pages serve.
void requestLargePages(AlignedBuffer& buffer) {
#if defined(__linux__)
  const std::int64_t bytes = buffer.size() * static_cast<std::int64_t>(sizeof(double));
  if (bytes < 2 * largePage) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(buffer.data());
  const std::uintptr_t first = (begin + largePage - 1) / largePage * largePage;
  const std::uintptr_t last = (begin + static_cast<std::uintptr_t>(bytes)) / largePage * largePage;
  if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#else
  static_cast<void>(buffer);
#endif
}

}  // namespace

void reserve(AlignedBuffer& buffer, std::int64_t size) {
  if (size <= buffer.size()) return;
  buffer = AlignedBuffer();
  buffer = AlignedBuffer(size, false);
  requestLargePages(buffer);
}

}  // namespace quiver::detail
