#include <quiver/solvers/cholesky/arena_planner.h>

#include <algorithm>
#include <iterator>

namespace quiver::detail {
namespace {

std::int64_t wholeLines(std::int64_t size) { return (size + 7) / 8 * 8; }

}  // namespace

std::int64_t ArenaPlanner::allocate(std::int64_t size) {
  size = wholeLines(size);
  if (size == 0) return 0;
  for (auto it = free_.begin(); it != free_.end(); ++it) {
    const auto [offset, available] = *it;
    if (available < size) continue;
    free_.erase(it);
    if (available > size) free_.emplace(offset + size, available - size);
    return offset;
  }
  const std::int64_t offset = end_;
  end_ += size;
  peak_ = std::max(peak_, end_);
  return offset;
}

void ArenaPlanner::release(std::int64_t offset, std::int64_t size) {
  size = wholeLines(size);
  if (size == 0) return;
  auto it = free_.emplace(offset, size).first;
  const auto after = std::next(it);
  if (after != free_.end() && it->first + it->second == after->first) {
    it->second += after->second;
    free_.erase(after);
  }
  if (it != free_.begin()) {
    const auto before = std::prev(it);
    if (before->first + before->second == it->first) {
      before->second += it->second;
      free_.erase(it);
      it = before;
    }
  }
  if (it->first + it->second == end_) {
    end_ = it->first;
    free_.erase(it);
  }
}

}  // namespace quiver::detail
