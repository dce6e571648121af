#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace quiver {

/// The root of everything quiver throws.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file that cannot be read as what it should be. `what()` is "FILE:LINE:COLUMN: message"; line and column count from
/// 1 and are left out where they are 0.
class ParseError : public Error {
 public:
  ParseError(std::string file, std::int64_t line, std::int64_t column, const std::string& message);

  const std::string& file() const { return file_; }
  std::int64_t line() const { return line_; }
  std::int64_t column() const { return column_; }
  /// The text after the location.
  const std::string& message() const { return message_; }

 private:
  std::string file_;
  std::int64_t line_;
  std::int64_t column_;
  std::string message_;
};

/// A graph used against its contract: an id twice, an edge to nowhere, an information matrix that is none.
class GraphError : public Error {
 public:
  using Error::Error;
};

/// A file or stream that cannot be opened, read or written.
class FileError : public Error {
 public:
  using Error::Error;
};

/// A plugin that cannot be loaded: missing, not a plugin, or of another ABI.
class PluginError : public Error {
 public:
  using Error::Error;
};

/// A broken invariant of quiver itself; the message carries the operands.
class LogicError : public Error {
 public:
  using Error::Error;
};

}  // namespace quiver
