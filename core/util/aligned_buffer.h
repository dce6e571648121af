#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace quiver {

namespace detail {

/// Memory for so many doubles from a 64-byte boundary on, not initialised. Large blocks ask for huge pages, which come
/// with fewer faults and cost the processor fewer translations. Throws std::bad_alloc.
double* allocateNumbers(std::int64_t count);
void freeNumbers(double* numbers) noexcept;

}  // namespace detail

/// A fixed-size array of doubles that starts on a 64-byte boundary; zeroed on request. Movable; copies copy the values.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::int64_t size, bool zero = true) : size_(size) {
    if (size == 0) return;
    data_.reset(detail::allocateNumbers(size));
    if (zero) {
      for (std::int64_t i = 0; i < size; ++i) data_.get()[i] = 0.0;
    }
  }
  AlignedBuffer(const AlignedBuffer& other) : AlignedBuffer(other.size_, false) {
    for (std::int64_t i = 0; i < size_; ++i) data_.get()[i] = other.data_.get()[i];
  }
  /// Allocates only if the sizes differ.
  AlignedBuffer& operator=(const AlignedBuffer& other) {
    if (size_ != other.size_) return *this = AlignedBuffer(other);
    for (std::int64_t i = 0; i < size_; ++i) data_.get()[i] = other.data_.get()[i];
    return *this;
  }
  AlignedBuffer(AlignedBuffer&& other) noexcept : data_(std::move(other.data_)), size_(other.size_) { other.size_ = 0; }
  AlignedBuffer& operator=(AlignedBuffer&& other) noexcept {
    data_ = std::move(other.data_);
    size_ = other.size_;
    other.size_ = 0;
    return *this;
  }

  double* data() { return data_.get(); }
  const double* data() const { return data_.get(); }
  std::int64_t size() const { return size_; }
  double& operator[](std::int64_t i) { return data_.get()[i]; }
  double operator[](std::int64_t i) const { return data_.get()[i]; }

 private:
  struct Free {
    void operator()(double* numbers) const { detail::freeNumbers(numbers); }
  };
  std::unique_ptr<double, Free> data_;
  std::int64_t size_ = 0;
};

}  // namespace quiver
