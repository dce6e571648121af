#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>

#include <quiver/core/io/text/number_parser.h>

namespace quiver::detail {
namespace {

bool startsWithIgnoringCase(const char* begin, const char* end, std::string_view lowerCase) {
  if (end - begin < static_cast<std::ptrdiff_t>(lowerCase.size())) return false;
  return std::equal(lowerCase.begin(), lowerCase.end(), begin,
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

/// The end of "nan", "nan(text)", "inf" or "infinity" at `p`, or `p` if it is none of them.
const char* skipNonFinite(const char* p, const char* end) {
  if (startsWithIgnoringCase(p, end, "infinity")) return p + 8;
  if (startsWithIgnoringCase(p, end, "inf")) return p + 3;
  if (!startsWithIgnoringCase(p, end, "nan")) return p;
  p += 3;
  if (p == end || *p != '(') return p;
  const char* close = p + 1;
  while (close != end && (std::isalnum(static_cast<unsigned char>(*close)) || *close == '_')) ++close;
  return close != end && *close == ')' ? close + 1 : p;
}

/// Whether an unsigned decimal number, known to be beyond the range of a double, is beyond it at the large end.
bool isHuge(const char* p, const char* end) {
  constexpr std::int64_t limit = 1'000'000'000'000;
  std::int64_t magnitude = 0;  // of the first digit that is not zero: 0.1 ≤ x / 10^magnitude < 1
  bool started = false;
  bool point = false;
  for (; p != end && (isDigit(*p) || *p == '.'); ++p) {
    if (*p == '.') {
      point = true;
      continue;
    }
    started = started || *p != '0';
    if (started && !point) ++magnitude;
    if (!started && point) --magnitude;
  }
  std::int64_t exponent = 0;
  bool negative = false;
  if (p != end) {
    ++p;
    if (p != end && (*p == '-' || *p == '+')) negative = *p++ == '-';
    for (; p != end && exponent < limit; ++p) exponent = 10 * exponent + (*p - '0');
  }
  return magnitude + (negative ? -exponent : exponent) > 0;
}

}  // namespace

ParsedNumber<double> parseRealExactly(const char* begin, const char* end) {
  const char* p = begin;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  if (p == end || !(isDigit(*p) || *p == '.')) {
    const char* word = skipNonFinite(p, end);
    return word == p ? ParsedNumber<double>{0.0, begin, NumberStatus::notANumber}
                     : ParsedNumber<double>{0.0, word, NumberStatus::notFinite};
  }
  double value = 0.0;
  const std::from_chars_result result = std::from_chars(p, end, value);
  if (result.ec == std::errc::invalid_argument) return {0.0, begin, NumberStatus::notANumber};
  if (result.ec == std::errc::result_out_of_range) {
    if (isHuge(p, result.ptr)) return {0.0, result.ptr, NumberStatus::outOfRange};
    value = 0.0;
  }
  return {negative ? -value : value, result.ptr, NumberStatus::ok};
}

ParsedNumber<std::int64_t> parseIntegerExactly(const char* begin, const char* end) {
  const char* p = begin;
  if (p != end && *p == '+') ++p;
  if (p != begin && p != end && *p == '-') return {0, begin, NumberStatus::notANumber};
  std::int64_t value = 0;
  const std::from_chars_result result = std::from_chars(p, end, value);
  if (result.ec == std::errc::invalid_argument) return {0, begin, NumberStatus::notANumber};
  if (result.ec == std::errc::result_out_of_range) return {0, result.ptr, NumberStatus::outOfRange};
  return {value, result.ptr, NumberStatus::ok};
}

}  // namespace quiver::detail
