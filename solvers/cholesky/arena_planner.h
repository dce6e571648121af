#pragma once

#include <cstdint>
#include <map>

namespace quiver::detail {

/// Simulates a first-fit allocator, so that all positions of temporary arrays are known before the numbers come.
class ArenaPlanner {
 public:
  /// The first free place of `size` doubles, rounded up to whole cache lines. O(free places).
  std::int64_t allocate(std::int64_t size);
  /// Gives back what allocate(size) returned.
  void release(std::int64_t offset, std::int64_t size);
  /// Doubles that are ever in use.
  std::int64_t peak() const { return peak_; }

 private:
  std::map<std::int64_t, std::int64_t> free_;  // offset → size, below end_
  std::int64_t end_ = 0;
  std::int64_t peak_ = 0;
};

}  // namespace quiver::detail
