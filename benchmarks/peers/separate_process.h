#pragma once

#include <functional>
#include <string>

namespace quiver::bench {

/// What a piece of work said, and what it cost its process.
struct SeparateResult {
  bool ok = false;
  std::string text;
  double peakMegabytes = 0.0;
};

/// Runs `work` in a child process, so that its peak memory is its own, and returns its text. ok is false when the child
/// died or threw.
SeparateResult inSeparateProcess(const std::function<std::string()>& work);

}  // namespace quiver::bench
