#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/io/text/source_text.h>
#include <quiver/core/io/text/text_scanner.h>

namespace quiver::detail {
namespace {

constexpr std::size_t longestQuote = 40;

bool isUtf8Continuation(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

std::string_view lineAround(std::string_view text, const char* place) {
  const char* begin = place;
  while (begin != text.data() && begin[-1] != '\n') --begin;
  const char* const end = std::find(place, text.data() + text.size(), '\n');
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string quoted(std::string_view token) {
  if (token.size() <= longestQuote) return fmt::format("'{}'", token);
  std::size_t length = longestQuote;
  while (length > 0 && isUtf8Continuation(token[length])) --length;
  return fmt::format("'{}…'", token.substr(0, length));
}

ParseError SourceText::error(const char* place, const std::string& message) const {
  if (const char* binary = findBinary(lineAround(text, place))) {
    const TextPosition position = locate(text, binary);
    return ParseError(name, position.line, position.column,
                      fmt::format("byte 0x{:02x} has no place in a text file", static_cast<unsigned char>(*binary)));
  }
  const TextPosition position = locate(text, place);
  return ParseError(name, position.line, position.column, message);
}

std::int64_t SourceText::lineOf(const char* place) const { return locate(text, place).line; }

const char* SourceText::linePlace(std::int64_t line) const {
  TextScanner scanner(text);
  for (std::int64_t i = 1; i < line && !scanner.atEnd(); ++i) scanner.nextLine();
  return scanner.cursor();
}

ParseError SourceText::badNumber(const char* place, NumberStatus status, bool integer) const {
  const std::string token = quoted(tokenAt(place));
  if (status == NumberStatus::notFinite) return error(place, fmt::format("{} is not a finite number", token));
  if (status == NumberStatus::outOfRange) {
    return error(place, fmt::format("{} is too large for {}", token, integer ? "a 64-bit integer" : "a double"));
  }
  if (integer) return error(place, fmt::format("{} is not an integer", token));
  const bool comma = tokenAt(place).find(',') != std::string_view::npos;
  return error(place, fmt::format("{} is not a number{}", token, comma ? "; decimals follow a point" : ""));
}

ParseError SourceText::endsEarly(const char* place, const std::string& whatIsMissing) const {
  const std::string_view line = lineAround(text, place);
  const std::size_t last = line.find_last_not_of(" \t\r");
  const std::size_t length = last == std::string_view::npos ? 0 : last + 1;
  return error(line.data() + length, fmt::format("the line ends early: {}", whatIsMissing));
}

std::string_view SourceText::tokenAt(const char* place) const {
  TextScanner scanner(std::string_view(place, static_cast<std::size_t>(end() - place)));
  return scanner.token();
}

const char* SourceText::tokenPlace(const char* place, int index) const {
  TextScanner scanner(std::string_view(place, static_cast<std::size_t>(end() - place)));
  for (int i = 0; i < index; ++i) scanner.token();
  scanner.atLineEnd();
  return scanner.cursor();
}

}  // namespace quiver::detail
