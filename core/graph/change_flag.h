#pragma once

#include <atomic>
#include <cstdint>

namespace quiver {

/// Whether anything of a graph's elements has changed, estimates aside, since somebody last asked.
class ChangeFlag {
 public:
  /// From any thread.
  void raise() noexcept {
    // Read first: threads that fill a graph together share the line as long as nobody writes to it.
    if (!raised_.load(std::memory_order_relaxed)) raised_.store(true, std::memory_order_relaxed);
  }
  /// Another number than the last time if something has changed since then.
  std::uint64_t revision() noexcept {
    if (raised_.exchange(false, std::memory_order_relaxed)) revision_.fetch_add(1, std::memory_order_relaxed);
    return revision_.load(std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> raised_{false};
  std::atomic<std::uint64_t> revision_{0};
};

/// How an element reaches the flag of its graph. A copy of the element belongs to no graph.
class ChangeLink {
 public:
  ChangeLink() = default;
  ChangeLink(const ChangeLink&) noexcept {}
  ChangeLink& operator=(const ChangeLink&) = delete;

  void join(ChangeFlag& flag) noexcept {
    flag_ = &flag;
    flag.raise();
  }
  void raise() const noexcept {
    if (flag_ != nullptr) flag_->raise();
  }

 private:
  ChangeFlag* flag_ = nullptr;
};

}  // namespace quiver
