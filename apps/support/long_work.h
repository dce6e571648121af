#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <quiver/core/graph/graph.h>
#include <quiver/core/util/stopwatch.h>

namespace quiver::app {

/// Tells the phases of long work on standard error as they begin, and nothing of short work.
class LongWork {
 public:
  explicit LongWork(bool quiet) : quiet_(quiet) {}

  /// Says that a file is read, if it is large.
  void reading(const std::string& path);
  /// Work on a large graph is long, whatever the size of its file.
  void expect(const Graph& graph);
  void tell(std::string_view phase) const;

 private:
  static constexpr std::uintmax_t longBytes = 30'000'000;
  static constexpr std::int64_t longElements = 300'000;

  bool quiet_;
  bool long_ = false;
  Stopwatch clock_;
};

}  // namespace quiver::app
