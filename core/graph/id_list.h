#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>

namespace quiver {

/// A short list of ids: up to three in place, more on the heap.
class IdList {
 public:
  static constexpr int inPlace = 3;

  IdList() = default;
  explicit IdList(std::span<const std::int64_t> ids) : size_(static_cast<int>(ids.size())) {
    if (size_ > inPlace) heap_ = std::make_unique<std::int64_t[]>(ids.size());
    std::copy(ids.begin(), ids.end(), data());
  }
  IdList(const IdList& other) : IdList(other.ids()) {}
  IdList& operator=(const IdList& other) { return *this = IdList(other); }
  IdList(IdList&&) noexcept = default;
  IdList& operator=(IdList&&) noexcept = default;

  std::span<const std::int64_t> ids() const { return {data(), static_cast<std::size_t>(size_)}; }
  int size() const { return size_; }
  std::int64_t operator[](int i) const { return data()[i]; }

 private:
  std::int64_t* data() { return heap_ ? heap_.get() : place_; }
  const std::int64_t* data() const { return heap_ ? heap_.get() : place_; }

  std::int64_t place_[inPlace] = {0, 0, 0};
  std::unique_ptr<std::int64_t[]> heap_;
  int size_ = 0;
};

}  // namespace quiver
