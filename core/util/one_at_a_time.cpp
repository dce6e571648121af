#include <quiver/core/util/one_at_a_time.h>

#include <mutex>

namespace quiver {

void oneAtATime(FunctionRef<void()> work) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  work();
}

}  // namespace quiver
