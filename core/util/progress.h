#pragma once

#include <atomic>
#include <thread>

namespace quiver {

/// How far a piece of work has come, for tasks of one loop that go on where earlier tasks of it end. Waiting spins: it
/// is for work of microseconds. parallelForWorkers takes tasks in ascending order, so a task that waits for earlier
/// ones alone never waits in vain.
class Progress {
 public:
  /// What was written before is seen by whoever waited for `steps` or fewer.
  void reach(int steps) { steps_.store(steps, std::memory_order_release); }

  /// Returns true once `steps` are reached, false as soon as the loop is called off.
  bool await(int steps, const std::atomic<bool>& calledOff) const {
    constexpr int patience = 2000;
    for (int looks = 0; steps_.load(std::memory_order_acquire) < steps; ++looks) {
      if (calledOff.load(std::memory_order_acquire)) return false;
      if (looks > patience) std::this_thread::yield();
    }
    return !calledOff.load(std::memory_order_acquire);
  }

 private:
  std::atomic<int> steps_{0};
};

}  // namespace quiver
