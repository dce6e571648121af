#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/util/aligned_buffer.h>

namespace quiver {

/// Where the values of each slot's estimate lie in a state: records of a few doubles, each type's records of the same
/// stride. Strides are 1, 2, 4 or a multiple of 8 doubles, so that a record does not straddle cache lines needlessly.
class StateLayout {
 public:
  /// Appends the record of the next slot.
  void append(int valueCount) {
    int stride = valueCount <= 2 ? valueCount : valueCount <= 4 ? 4 : (valueCount + 7) / 8 * 8;
    if (stride >= 8) size_ = (size_ + 7) / 8 * 8;
    offsets_.push_back(size_);
    counts_.push_back(valueCount);
    size_ += stride;
  }
  std::int64_t offset(int slot) const { return offsets_[static_cast<std::size_t>(slot)]; }
  const std::int64_t* offsets() const { return offsets_.data(); }
  int valueCount(int slot) const { return counts_[static_cast<std::size_t>(slot)]; }
  int slots() const { return static_cast<int>(offsets_.size()); }
  /// Doubles of a state; eight of slack at the end, so whole vectors may be read.
  std::int64_t size() const { return size_ + 8; }

 private:
  std::vector<std::int64_t> offsets_;
  std::vector<std::int32_t> counts_;
  std::int64_t size_ = 0;
};

/// The estimates of all slots of a problem, fixed ones included.
class State {
 public:
  State() = default;
  explicit State(const StateLayout& layout) : offsets_(layout.offsets()), values_(layout.size()) {}

  const double* record(int slot) const { return values_.data() + offsets_[slot]; }
  double* record(int slot) { return values_.data() + offsets_[slot]; }
  const double* data() const { return values_.data(); }
  double* data() { return values_.data(); }
  const std::int64_t* offsets() const { return offsets_; }

 private:
  const std::int64_t* offsets_ = nullptr;
  AlignedBuffer values_;
};

}  // namespace quiver
