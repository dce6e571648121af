#pragma once

#include <cstddef>
#include <cstdint>

namespace quiver {

enum class NumberStatus {
  ok,
  notANumber,
  /// NaN or an infinity, spelled out.
  notFinite,
  /// Beyond the largest double or 64-bit integer.
  outOfRange,
};

/// A number and the first character after it. Where the status is not `ok` the value is zero; `end` is then the first
/// character that cannot belong to a number (`begin` itself if there is no number at all).
template <typename Number>
struct ParsedNumber {
  Number value;
  const char* end;
  NumberStatus status;
};

namespace detail {

/// parseReal() for every spelling; slower.
ParsedNumber<double> parseRealExactly(const char* begin, const char* end);
/// parseInteger() for every number of digits; slower.
ParsedNumber<std::int64_t> parseIntegerExactly(const char* begin, const char* end);

inline constexpr double powersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                         1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
inline constexpr int largestExactPowerOfTen = 22;
inline constexpr std::uint64_t largestExactMantissa = std::uint64_t{1} << 53;

inline bool isDigit(char c) { return static_cast<unsigned char>(c - '0') <= 9; }

/// Appends the digits from `p` on to `mantissa` (modulo 2⁶⁴) and moves `p` behind them.
inline void accumulateDigits(const char*& p, const char* end, std::uint64_t& mantissa) {
  while (p != end && isDigit(*p)) mantissa = 10 * mantissa + static_cast<std::uint64_t>(*p++ - '0');
}

/// Reads "e-12" and its like: at most three digits. Returns false for anything else.
inline bool parseShortExponent(const char*& p, const char* end, int& exponent) {
  const char* digit = p + 1;
  bool negative = false;
  if (digit != end && (*digit == '-' || *digit == '+')) negative = *digit++ == '-';
  const char* first = digit;
  int value = 0;
  while (digit != end && isDigit(*digit) && digit - first < 4) value = 10 * value + (*digit++ - '0');
  if (digit == first || digit - first > 3) return false;
  exponent += negative ? -value : value;
  p = digit;
  return true;
}

}  // namespace detail

/// Reads the longest decimal number at the front of [begin, end): optional sign, digits with an optional point,
/// optional exponent. Correctly rounded (to nearest, ties to even), whatever the locale. Too large is `outOfRange`, too
/// small reads as a zero of its sign; "nan" and "inf" in any spelling are `notFinite`.
///
/// Two doubles below 2⁵³ and 10²³ are exact, and one IEEE operation on them rounds once: nearly every number of nearly
/// every file takes that way; the others take std::from_chars.
inline ParsedNumber<double> parseReal(const char* begin, const char* end) {
  const char* p = begin;
  bool negative = false;
  if (p != end && (*p == '-' || *p == '+')) negative = *p++ == '-';
  std::uint64_t mantissa = 0;
  const char* const first = p;
  detail::accumulateDigits(p, end, mantissa);
  std::ptrdiff_t digits = p - first;
  int exponent = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    detail::accumulateDigits(p, end, mantissa);
    const std::ptrdiff_t decimals = p - fraction;
    digits += decimals;
    exponent = decimals <= 19 ? -static_cast<int>(decimals) : 0;
  }
  // 19 digits fit in 64 bits, so beyond that the mantissa may have wrapped.
  if (digits == 0 || digits > 19 || mantissa > detail::largestExactMantissa)
    return detail::parseRealExactly(begin, end);
  if (p != end && (*p == 'e' || *p == 'E') && !detail::parseShortExponent(p, end, exponent)) {
    return detail::parseRealExactly(begin, end);
  }
  if (exponent < -detail::largestExactPowerOfTen || exponent > detail::largestExactPowerOfTen) {
    return detail::parseRealExactly(begin, end);
  }
  double value = static_cast<double>(mantissa);
  value = exponent < 0 ? value / detail::powersOfTen[-exponent] : value * detail::powersOfTen[exponent];
  return {negative ? -value : value, p, NumberStatus::ok};
}

/// Reads the longest decimal integer at the front of [begin, end): optional sign, digits.
inline ParsedNumber<std::int64_t> parseInteger(const char* begin, const char* end) {
  const char* p = begin;
  bool negative = false;
  if (p != end && (*p == '-' || *p == '+')) negative = *p++ == '-';
  std::uint64_t magnitude = 0;
  const char* const first = p;
  detail::accumulateDigits(p, end, magnitude);
  if (p == first || p - first > 18) return detail::parseIntegerExactly(begin, end);
  const auto value = static_cast<std::int64_t>(magnitude);
  return {negative ? -value : value, p, NumberStatus::ok};
}

}  // namespace quiver
