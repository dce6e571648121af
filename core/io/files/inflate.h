#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <string>
#include <string_view>

namespace quiver::detail {

/// Bytes in memory of their own that grow without being cleared first.
class ByteBuffer {
 public:
  ByteBuffer() = default;
  ~ByteBuffer() { std::free(data_); }
  ByteBuffer(const ByteBuffer&) = delete;
  ByteBuffer& operator=(const ByteBuffer&) = delete;

  char* data() { return data_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  /// Makes room for `bytes` more behind the present ones, at least doubling.
  void makeRoom(std::size_t bytes) {
    if (capacity_ - size_ >= bytes) return;
    const std::size_t capacity = capacity_ + (bytes > capacity_ ? bytes : capacity_);
    void* grown = std::realloc(data_, capacity);
    if (!grown) throw std::bad_alloc();
    data_ = static_cast<char*>(grown);
    capacity_ = capacity;
  }
  /// Counts `bytes` behind the present ones, just written by the caller, as part of the buffer.
  void append(std::size_t bytes) { size_ += bytes; }
  /// Hands the memory over; to be freed with std::free.
  char* take() {
    char* data = data_;
    data_ = nullptr;
    size_ = capacity_ = 0;
    return data;
  }

 private:
  char* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

enum class Compression { none, gzip, bzip2 };

/// By the first bytes.
Compression detectCompression(std::string_view bytes);

/// Inflates all members of a gzip file, or all streams of a bzip2 file, one after the other. Throws ParseError about
/// `name` if the data is corrupt, ends early or is followed by something else (zeros apart), FileError if it grows
/// beyond `maxBytes`.
void inflateAll(Compression compression, std::string_view bytes, const std::string& name, std::size_t maxBytes,
                ByteBuffer& out);

}  // namespace quiver::detail
