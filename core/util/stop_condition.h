#pragma once

#include <chrono>
#include <limits>
#include <stop_token>

namespace quiver {

/// Why long work should end early: a deadline, a stop token, or both. Cheap enough to be asked every few microseconds
/// of work; asking is safe from any thread.
class StopCondition {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Reason { none, interrupted, timeLimit };

  StopCondition() = default;
  /// `seconds` from now; infinity means no deadline.
  explicit StopCondition(double seconds, std::stop_token token = {}) : token_(std::move(token)) {
    if (seconds < 1e9)
      deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  Reason reason() const {
    if (token_.stop_requested()) return Reason::interrupted;
    if (deadline_ != Clock::time_point::max() && Clock::now() >= deadline_) return Reason::timeLimit;
    return Reason::none;
  }
  bool reached() const { return reason() != Reason::none; }

 private:
  Clock::time_point deadline_ = Clock::time_point::max();
  std::stop_token token_;
};

}  // namespace quiver
