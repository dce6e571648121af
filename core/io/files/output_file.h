#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <quiver/core/io/files/deflate.h>

namespace quiver {

/// A file that appears whole or not at all.
///
/// What is written goes to a temporary file in the target's folder; commit() renames it onto the target, and without
/// commit() it is removed: an old file stays as it was until the new one is complete. An existing target keeps its mode
/// (and its owner where the system lets it), symbolic links are followed. Names that end in .gz or .bz2 are compressed.
/// "-" is standard output; it and targets that are no regular files (devices, pipes) are written directly.
class OutputFile {
 public:
  /// Throws FileError if the target is a directory, is write-protected, or cannot be made.
  explicit OutputFile(const std::string& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws FileError if the system refuses, as when the disk is full.
  void write(std::string_view bytes);
  /// Completes the file, on the disk too, and puts it in its place. Throws FileError if that fails; the target is then
  /// the old one. To be called once, last.
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(int error) const;

  std::string name_;       // for messages
  std::string target_;     // what commit() replaces; empty if written directly
  std::string temporary_;  // empty if there is none (any more)
  int descriptor_ = -1;
  bool ownsDescriptor_ = false;
  bool committed_ = false;
  std::unique_ptr<detail::Compressor> compressor_;
  std::string buffer_;
  std::string compressed_;
};

/// Throws FileError if an OutputFile of this path could not be opened: to be asked before long work. Leaves no trace.
void checkWritable(const std::string& path);

}  // namespace quiver
