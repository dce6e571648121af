#include <quiver/core/util/signals_blocked.h>
#include <quiver/core/util/thread_pool.h>

#include <algorithm>
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

ThreadPool::Loop::Loop(FunctionRef<void(std::int64_t)> what, std::int64_t count, int helpers)
    : task(what), openings(helpers), runCount(std::min(helpers + 1, mostRuns)) {
  for (int r = 0; r < runCount; ++r) {
    Run& run = runs[static_cast<std::size_t>(r)];
    run.next.store(count * r / runCount, std::memory_order_relaxed);
    run.end = count * (r + 1) / runCount;
  }
}

void ThreadPool::work(Loop& loop, int run) {
  inside = true;
  for (int k = 0; k < loop.runCount; ++k) {
    Run& tasks = loop.runs[static_cast<std::size_t>((run + k) % loop.runCount)];
    for (std::int64_t i = tasks.next.fetch_add(1); i < tasks.end; i = tasks.next.fetch_add(1)) loop.task(i);
  }
  inside = false;
}

void ThreadPool::startThreads(int count) {
  if (static_cast<int>(threads_.size()) >= count) return;
  // Asking for the number of cores reads a file, 6 µs: not in every loop.
  const std::size_t cores = std::thread::hardware_concurrency();
  const SignalsBlocked blocked;
  while (static_cast<int>(threads_.size()) < count) {
    const auto number = static_cast<int>(threads_.size()) + 1;
    const bool ownCore = static_cast<std::size_t>(number) < cores;
    try {
      threads_.emplace_back([this, number, ownCore] { help(number, ownCore ? spins : spinsBeyondMachine); });
    } catch (const std::system_error&) {
      return;  // those there are do the work
    }
  }
}

void ThreadPool::run(std::int64_t count, int helpers, FunctionRef<void(std::int64_t)> task) {
  Loop loop(task, count, helpers);
  const std::unique_lock alone(callers_, std::try_to_lock);
  if (!alone.owns_lock()) return work(loop, 0);
  startThreads(helpers);
  {
    const std::lock_guard lock(mutex_);
    loop_ = &loop;
    published_.fetch_add(1);
  }
  wake_.notify_all();
  work(loop, 0);
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

void ThreadPool::help(int number, int looks) {
  std::uint64_t seen = 0;
  while (true) {
    awake_.fetch_add(1, std::memory_order_relaxed);
    for (int i = 0; i < looks && published_.load(std::memory_order_relaxed) == seen; ++i) pause();
    awake_.fetch_sub(1, std::memory_order_relaxed);
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
    work(*loop, number);
    active_.fetch_sub(1, std::memory_order_release);
  }
}

}  // namespace quiver::detail
