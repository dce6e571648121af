#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace quiver {

/// A whole file in memory, as text: plain, gzip or bzip2, told apart by their first bytes and not by the file's name.
///
/// Plain files are mapped, so opening costs nothing and their pages are read when they are touched; they must not be
/// truncated while the object lives. "-" is standard input. Movable; text() stays where it is when the object moves.
class InputFile {
 public:
  /// Throws FileError if the path is missing, a directory, unreadable, or inflates to more than `maxBytes` (0:
  /// half of the machine's memory); throws ParseError if compressed data is corrupt or ends early.
  explicit InputFile(const std::string& path, std::int64_t maxBytes = 0);
  ~InputFile();
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&& other) noexcept;
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  std::string_view text() const { return {data_, size_}; }
  /// The path, or "<stdin>": what messages call the file.
  const std::string& name() const { return name_; }
  /// Size before inflating.
  std::int64_t storedBytes() const { return storedBytes_; }

 private:
  void load(const std::string& path);
  void map(int descriptor, std::size_t size);
  void readAll(int descriptor);
  void inflateIfCompressed(std::int64_t maxBytes);
  void release();

  std::string name_;
  const char* data_ = nullptr;
  std::size_t size_ = 0;
  std::int64_t storedBytes_ = 0;
  bool mapped_ = false;  // data_ is a mapping; otherwise it is owned memory from std::malloc
};

}  // namespace quiver
