#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include <quiver/core/io/text/short_decimal.h>

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

  /// Whether the text goes on with `token` (not empty) and the token ends there; then moves behind it.
  bool skipToken(std::string_view token) {
    const std::size_t size = token.size();
    const auto left = static_cast<std::size_t>(end_ - cursor_);
    if (size == 0 || left < size || std::memcmp(cursor_, token.data(), size) != 0) return false;
    if (left > size && !isSeparator(cursor_[size])) return false;
    cursor_ += size;
    return true;
  }

  /// The next token as a number. If it is none, the cursor stays before it and the status says why; at the end of the
  /// line that is `notANumber`.
  NumberStatus real(double& value) {
    return number([](auto... range) { return parseReal(range...); }, value);
  }
  NumberStatus integer(std::int64_t& value) {
    return number([](auto... range) { return parseInteger(range...); }, value);
  }

  /// Reads numbers of the common short form (see shortDecimal) as long as there are any, at most out.size() of them;
  /// returns how many. `last` is set to the place of the last one. `begin` is where readable memory begins.
  std::size_t shortReals([[maybe_unused]] const char* begin, [[maybe_unused]] std::span<double> out,
                         [[maybe_unused]] const char*& last) {
    std::size_t count = 0;
#ifdef __SSE2__
    if (cursor_ - begin < detail::shortDecimalMargin) return 0;
    const char* const lastSafe = end_ - std::min<std::ptrdiff_t>(end_ - cursor_, detail::shortDecimalMargin);
    const char* place = cursor_;
    for (; count < out.size(); ++count) {
      while (place < lastSafe && isBlank(*place)) ++place;
      if (place >= lastSafe) break;
      const char* next = place + 1;
      if (*next == ' ' && detail::isDigit(*place)) {
        out[count] = *place - '0';  // a matrix's zeros and ones
      } else {
        next = detail::shortDecimal(place, out[count]);
        if (!next) break;
      }
      last = place;
      place = next;
      cursor_ = next;
    }
#endif
    return count;
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
