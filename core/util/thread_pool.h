#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include <quiver/core/util/function_ref.h>

namespace quiver::detail {

/// Threads that wait for loops. A loop's caller works too and waits at the end only for helpers that really began: on a
/// busy machine, where a helper may not get a core for milliseconds, the caller does all the work itself instead of
/// waiting for it.
///
/// A loop's tasks are divided into runs, one for each thread, and a thread that is done with its own takes what is left
/// of the others'. So loops over the same things find most of them in the cache where the loop before left them.
class ThreadPool {
 public:
  /// The one pool of the process; threads start when they are first asked for.
  static ThreadPool& instance();
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Calls task(0) … task(count − 1) on the calling thread and at most `helpers` others. Tasks must not throw. If
  /// another thread is inside a loop at the moment, the caller works alone.
  void run(std::int64_t count, int helpers, FunctionRef<void(std::int64_t)> task);
  /// Helpers that look out for a loop at the moment: they join at once, where others must be woken first.
  int awake() const { return awake_.load(std::memory_order_relaxed); }
  /// Whether the calling thread is inside a task.
  static bool insideTask();

 private:
  static constexpr int mostRuns = 16;
  struct alignas(64) Run {
    std::atomic<std::int64_t> next{0};
    std::int64_t end = 0;
  };
  struct Loop {
    Loop(FunctionRef<void(std::int64_t)> task, std::int64_t count, int helpers);
    FunctionRef<void(std::int64_t)> task;
    int openings;  // helpers that may still join; guarded by mutex_
    int runCount;
    std::array<Run, mostRuns> runs;
  };

  ThreadPool() = default;
  /// Takes tasks of the run with this number first.
  static void work(Loop& loop, int run);
  /// Joins loops for ever as helper `number`; looks so often for the next one before it sleeps.
  void help(int number, int looks);
  void startThreads(int count);
  void waitForHelpers();

  std::mutex callers_;  // held for the length of a loop
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::thread> threads_;
  Loop* loop_ = nullptr;                     // guarded by mutex_
  bool ending_ = false;                      // guarded by mutex_
  std::atomic<std::uint64_t> published_{0};  // counts loops, for those who look without the lock
  std::atomic<int> awake_{0};
  std::atomic<int> active_{0};  // helpers inside the current loop; rises under mutex_ only
};

}  // namespace quiver::detail
