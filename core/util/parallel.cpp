#include <quiver/core/util/parallel.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#ifdef QUIVER_OPENMP
#  include <omp.h>
#else
#  include <quiver/core/util/thread_pool.h>
#endif

namespace quiver {
namespace {

/// Keeps the first exception of a loop; later tasks are skipped.
class FirstException {
 public:
  bool raised() const { return raised_.load(std::memory_order_relaxed); }
  void capture() {
    if (!raised_.exchange(true)) exception_ = std::current_exception();
  }
  void rethrow() {
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  std::atomic<bool> raised_{false};
  std::exception_ptr exception_;
};

bool nested() {
#ifdef QUIVER_OPENMP
  return omp_in_parallel() != 0;
#else
  return detail::ThreadPool::insideTask();
#endif
}

}  // namespace

int hardwareThreads() {
#ifdef QUIVER_OPENMP
  return omp_get_max_threads();
#else
  const unsigned count = std::thread::hardware_concurrency();
  return count == 0 ? 1 : static_cast<int>(count);
#endif
}

int readyThreads(int threads) {
#ifdef QUIVER_OPENMP
  return threads;
#else
  return std::min(threads, 1 + detail::ThreadPool::instance().awake());
#endif
}

int worthwhileThreads(int threads, double nanoseconds) {
  // Waking a sleeping thread takes six times as long, but between the loops of a solve threads do not sleep, and
  // meeting one that waits takes less than a microsecond.
  constexpr double leastShare = 1.0e4;
  return static_cast<int>(std::clamp(nanoseconds / leastShare, 1.0, static_cast<double>(std::max(1, threads))));
}

void parallelFor(std::int64_t count, int threads, FunctionRef<void(std::int64_t)> task) {
  if (threads > count) threads = static_cast<int>(count);
  if (threads <= 1 || nested()) {
    for (std::int64_t i = 0; i < count; ++i) task(i);
    return;
  }
  FirstException first;
  const auto guarded = [&](std::int64_t i) {
    if (first.raised()) return;
    try {
      task(i);
    } catch (...) {
      first.capture();
    }
  };
#ifdef QUIVER_OPENMP
#  pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
  for (std::int64_t i = 0; i < count; ++i) guarded(i);
#else
  detail::ThreadPool::instance().run(count, threads - 1, guarded);
#endif
  first.rethrow();
}

void parallelForWorkers(std::int64_t count, int workers, int threads, FunctionRef<void(std::int64_t, int)> task) {
  std::atomic<std::int64_t> next{0};
  parallelFor(workers, threads, [&](std::int64_t worker) {
    for (std::int64_t i = next++; i < count; i = next++) task(i, static_cast<int>(worker));
  });
}

}  // namespace quiver
