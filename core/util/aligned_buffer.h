#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <utility>

namespace quiver {

/// A fixed-size array of doubles that starts on a 64-byte boundary; zeroed on request. Movable; copies copy the values.
class AlignedBuffer {
 public:
  AlignedBuffer() = default;
  explicit AlignedBuffer(std::int64_t size, bool zero = true) : size_(size) {
    if (size == 0) return;
    data_.reset(
        static_cast<double*>(::operator new (static_cast<std::size_t>(size) * sizeof(double), std::align_val_t{64})));
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
    void operator()(double* pointer) const { ::operator delete (pointer, std::align_val_t{64}); }
  };
  std::unique_ptr<double, Free> data_;
  std::int64_t size_ = 0;
};

}  // namespace quiver
