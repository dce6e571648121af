#include <quiver/core/util/thread_pool.h>

#include <system_error>

namespace quiver::detail {
namespace {

/// How often an idle thread looks before it sleeps: a third of a millisecond, more than the pauses between the loops of
/// one computation. Threads beyond the machine's would only keep the others from working.
constexpr int spins = 20000;
constexpr int spinsBeyondMachine = 100;
/// How often a caller looks whether its helpers are done before it lets others have its core.
constexpr int spinsAtEnd = 2000;

thread_local bool inside = false;

void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

ThreadPool& ThreadPool::instance() {
  static ThreadPool pool;
  return pool;
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    published_.fetch_add(1);
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool ThreadPool::insideTask() { return inside; }

void ThreadPool::work(Loop& loop) {
  inside = true;
  for (std::int64_t i = loop.next.fetch_add(1); i < loop.count; i = loop.next.fetch_add(1)) loop.task(i);
  inside = false;
}

void ThreadPool::startThreads(int count) {
  if (static_cast<int>(threads_.size()) >= count) return;
  // Asking for the number of cores reads a file, 6 µs: not in every loop.
  const std::size_t cores = std::thread::hardware_concurrency();
  while (static_cast<int>(threads_.size()) < count) {
    const bool ownCore = threads_.size() + 1 < cores;
    try {
      threads_.emplace_back([this, ownCore] { help(ownCore ? spins : spinsBeyondMachine); });
    } catch (const std::system_error&) {
      return;  // those there are do the work
    }
  }
}

void ThreadPool::run(std::int64_t count, int helpers, FunctionRef<void(std::int64_t)> task) {
  Loop loop{task, count, {}, helpers};
  const std::unique_lock alone(callers_, std::try_to_lock);
  if (!alone.owns_lock()) return work(loop);
  startThreads(helpers);
  {
    const std::lock_guard lock(mutex_);
    loop_ = &loop;
    published_.fetch_add(1);
  }
  wake_.notify_all();
  work(loop);
  {
    const std::lock_guard lock(mutex_);
    loop_ = nullptr;  // nobody joins from here on
  }
  waitForHelpers();
}

void ThreadPool::waitForHelpers() {
  for (int i = 0; active_.load(std::memory_order_acquire) != 0; ++i) {
    if (i < spinsAtEnd) {
      pause();
    } else {
      std::this_thread::yield();
    }
  }
}

void ThreadPool::help(int looks) {
  std::uint64_t seen = 0;
  while (true) {
    for (int i = 0; i < looks && published_.load(std::memory_order_relaxed) == seen; ++i) pause();
    Loop* loop = nullptr;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return ending_ || published_.load(std::memory_order_relaxed) != seen; });
      if (ending_) return;
      seen = published_.load(std::memory_order_relaxed);
      if (loop_ != nullptr && loop_->openings > 0) {
        loop = loop_;
        --loop->openings;
        active_.fetch_add(1, std::memory_order_relaxed);
      }
    }
    if (loop == nullptr) continue;
    work(*loop);
    active_.fetch_sub(1, std::memory_order_release);
  }
}

}  // namespace quiver::detail
