#pragma once

#include <chrono>
#include <limits>
#include <stop_token>

#include <quiver/core/util/error.h>

namespace quiver {

/// Thrown out of work that a stop condition ends in its midst.
class WorkStopped : public Error {
 public:
  WorkStopped() : Error("the time is over, or a stop was asked for") {}
};

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
  void throwIfReached() const {
    if (reached()) throw WorkStopped();
  }

 private:
  Clock::time_point deadline_ = Clock::time_point::max();
  std::stop_token token_;
};

}  // namespace quiver
