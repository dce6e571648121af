#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <quiver/core/io/text/number_parser.h>

namespace quiver {

/// A place in a text; both count from 1, columns in bytes.
struct TextPosition {
  std::int64_t line = 1;
  std::int64_t column = 1;
};

/// The line and column of `place`, which lies in `text` or at its end. O(place − begin): for messages only.
inline TextPosition locate(std::string_view text, const char* place) {
  TextPosition result;
  const char* lineBegin = text.data();
  for (const char* p = lineBegin; p != place;) {
    const auto* feed = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(place - p)));
    if (!feed) break;
    ++result.line;
    p = lineBegin = feed + 1;
  }
  result.column = place - lineBegin + 1;
  return result;
}

/// Whether a byte has no place in a text file: NUL and the other control characters except tab, line feed and carriage
/// return.
inline bool isBinary(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7f;
}

/// The first binary byte of a piece of text, or nullptr.
inline const char* findBinary(std::string_view text) {
  const auto found = std::find_if(text.begin(), text.end(), isBinary);
  return found == text.end() ? nullptr : text.data() + (found - text.begin());
}

/// Reads a text token by token. Tokens are separated by spaces, tabs and carriage returns; a line feed ends the line,
/// and no function but nextLine() passes it. Keeps no line numbers: places are pointers, locate() turns them into lines
/// and columns.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : cursor_(text.data()), end_(text.data() + text.size()) {}

  /// Where the next token starts, if blanks have been skipped, or the rest of the line.
  const char* cursor() const { return cursor_; }
  /// Whether the whole text has been read.
  bool atEnd() const { return cursor_ == end_; }
  /// Skips blanks; whether nothing but the line's end follows.
  bool atLineEnd() {
    skipBlanks();
    return cursor_ == end_ || *cursor_ == '\n';
  }

  /// The next token; empty at the end of the line.
  std::string_view token() {
    skipBlanks();
    const char* const begin = cursor_;
    while (cursor_ != end_ && !isSeparator(*cursor_)) ++cursor_;
    return {begin, static_cast<std::size_t>(cursor_ - begin)};
  }

  /// The next token as a number. If it is none, the cursor stays before it and the status says why; at the end of the
  /// line that is `notANumber`.
  NumberStatus real(double& value) {
    return number([](auto... range) { return parseReal(range...); }, value);
  }
  NumberStatus integer(std::int64_t& value) {
    return number([](auto... range) { return parseInteger(range...); }, value);
  }

  /// The rest of the line without its end, and moves to the next one.
  std::string_view nextLine() {
    const char* const begin = cursor_;
    if (begin == end_) return {};
    const auto* feed = static_cast<const char*>(std::memchr(begin, '\n', static_cast<std::size_t>(end_ - begin)));
    const char* stop = feed ? feed : end_;
    cursor_ = feed ? feed + 1 : end_;
    if (stop != begin && stop[-1] == '\r') --stop;
    return {begin, static_cast<std::size_t>(stop - begin)};
  }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  static bool isSeparator(char c) { return isBlank(c) || c == '\n'; }

  void skipBlanks() {
    while (cursor_ != end_ && isBlank(*cursor_)) ++cursor_;
  }

  template <typename Parse, typename Number>
  NumberStatus number(Parse parse, Number& value) {
    skipBlanks();
    const ParsedNumber<Number> parsed = parse(cursor_, end_);
    if (parsed.end != end_ && !isSeparator(*parsed.end)) return NumberStatus::notANumber;
    if (parsed.status != NumberStatus::ok) return parsed.status;
    value = parsed.value;
    cursor_ = parsed.end;
    return NumberStatus::ok;
  }

  const char* cursor_;
  const char* end_;
};

}  // namespace quiver
