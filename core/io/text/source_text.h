#pragma once

#include <string>
#include <string_view>

#include <quiver/core/io/text/number_parser.h>
#include <quiver/core/util/error.h>

namespace quiver::detail {

/// A text and what messages call it. Refers to both; owns neither.
struct SourceText {
  std::string_view text;
  const std::string& name;

  const char* begin() const { return text.data(); }
  const char* end() const { return text.data() + text.size(); }

  /// An error about `place`, a pointer into the text. If the line of `place` holds binary bytes, the error is about the
  /// first of them.
  ParseError error(const char* place, const std::string& message) const;
  /// The line of `place`, counted from 1. O(place − begin).
  std::int64_t lineOf(const char* place) const;

  /// Where the line of that number begins; the text's end if there are fewer.
  const char* linePlace(std::int64_t line) const;

  /// An error about the token at `place`, which does not read as a number (or, for `integer`, as a 64-bit integer).
  ParseError badNumber(const char* place, NumberStatus status, bool integer) const;
  /// An error about the end of the line that `place` is on: something is missing there.
  ParseError endsEarly(const char* place, const std::string& whatIsMissing) const;

  /// The token that starts at `place`, up to the next blank.
  std::string_view tokenAt(const char* place) const;
  /// The token number `index` (0: the first) from `place` on, on the same line; the line's end if it has fewer.
  const char* tokenPlace(const char* place, int index) const;
};

/// A token as a message shows it: in quotes, cut off after some 40 bytes, never in the middle of a character.
std::string quoted(std::string_view token);

}  // namespace quiver::detail
