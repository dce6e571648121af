#pragma once

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
  /// Whether the calling thread is inside a task.
  static bool insideTask();

 private:
  struct Loop {
    FunctionRef<void(std::int64_t)> task;
    std::int64_t count;
    std::atomic<std::int64_t> next{0};
    int openings;  // helpers that may still join; guarded by mutex_
  };

  ThreadPool() = default;
  static void work(Loop& loop);
  /// Joins loops for ever; looks so often for the next one before it sleeps.
  void help(int looks);
  void startThreads(int count);
  void waitForHelpers();

  std::mutex callers_;  // held for the length of a loop
  std::mutex mutex_;
  std::condition_variable wake_;
  std::vector<std::thread> threads_;
  Loop* loop_ = nullptr;                     // guarded by mutex_
  bool ending_ = false;                      // guarded by mutex_
  std::atomic<std::uint64_t> published_{0};  // counts loops, for those who look without the lock
  std::atomic<int> active_{0};               // helpers inside the current loop; rises under mutex_ only
};

}  // namespace quiver::detail
