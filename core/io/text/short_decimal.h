#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#ifdef __SSE2__
#  include <emmintrin.h>
#endif

#include <quiver/core/io/text/number_parser.h>

namespace quiver::detail {

#ifdef __SSE2__

/// Bytes that shortDecimal() looks at before and after the place it is given.
inline constexpr std::ptrdiff_t shortDecimalMargin = 16;

/// The value of sixteen decimal digits, the first of them in the lowest byte.
inline std::uint64_t sixteenDigits(__m128i digits) {
  // Neighbours join: eight numbers of two digits, four of four, two of eight.
  const __m128i tens = _mm_mullo_epi16(_mm_and_si128(digits, _mm_set1_epi16(0xff)), _mm_set1_epi16(10));
  const __m128i pairs = _mm_add_epi16(tens, _mm_srli_epi16(digits, 8));
  const __m128i fours = _mm_madd_epi16(pairs, _mm_set1_epi32(100 + (1 << 16)));
  const __m128i packed = _mm_packs_epi32(fours, fours);
  const auto eights =
      static_cast<std::uint64_t>(_mm_cvtsi128_si64(_mm_madd_epi16(packed, _mm_set1_epi32(10000 + (1 << 16)))));
  return (eights & 0xffffffff) * 100000000 + (eights >> 32);
}

/// Reads a decimal number of the common form at `p`: an optional minus and digits with an optional point, fifteen bytes
/// at most, and a blank or a line's end behind them. Returns its end and the same value as parseReal(), or nullptr if
/// the token is of another form. Needs shortDecimalMargin readable bytes on either side of `p`.
///
/// Where the token ends and where its point is are found at once, so that there is no loop, and no branch whose
/// direction the digits decide: a wrong guess of the processor costs as much as the whole number.
inline const char* shortDecimal(const char* p, double& value) {
  // Lanes from 16 − n on, for n = 0 … 16, when read from byte n.
  alignas(16) static constexpr std::uint8_t lastLanes[32] = {
      0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,    0,
      0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
  const auto load = [](const void* from) { return _mm_loadu_si128(static_cast<const __m128i*>(from)); };
  const __m128i bytes = load(p);
  const auto blanks = static_cast<unsigned>(_mm_movemask_epi8(_mm_cmplt_epi8(bytes, _mm_set1_epi8('!'))));
  if (blanks == 0) return nullptr;
  const int length = __builtin_ctz(blanks);
  const char* const end = p + length;
  if (*end != ' ' && *end != '\n' && *end != '\r' && *end != '\t') return nullptr;
  const auto points =
      static_cast<unsigned>(_mm_movemask_epi8(_mm_cmpeq_epi8(bytes, _mm_set1_epi8('.')))) & ((1u << length) - 1);
  // By arithmetic: an instruction that sets one byte by a comparison waits for the rest of its register, which here
  // comes to hold the number before, and numbers would be read one after the other.
  const int negative = static_cast<int>((static_cast<unsigned>(static_cast<unsigned char>(*p) ^ '-') - 1u) >> 31);
  const int pointed = static_cast<int>((0u - points) >> 31);
  const int digits = length - negative - pointed;
  if (digits <= 0) return nullptr;
  const int decimals = (length - 1 - __builtin_ctz(points | 0x8000)) & -pointed;
  // Digits behind the point end at `end`; those before it are moved by one byte, over the point.
  const int behind = decimals | (digits & (pointed - 1));
  const __m128i fraction = load(lastLanes + behind);
  const __m128i all = load(lastLanes + digits);
  const __m128i text =
      _mm_or_si128(_mm_and_si128(fraction, load(end - 16)), _mm_andnot_si128(fraction, load(end - 17)));
  const __m128i numbers = _mm_and_si128(_mm_sub_epi8(text, _mm_set1_epi8('0')), all);
  const __m128i small = _mm_cmpeq_epi8(_mm_min_epu8(numbers, _mm_set1_epi8(9)), numbers);
  if (_mm_movemask_epi8(small) != 0xffff) return nullptr;
  const double magnitude =
      static_cast<double>(static_cast<std::int64_t>(sixteenDigits(numbers))) / powersOfTen[decimals];
  value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(magnitude) | static_cast<std::uint64_t>(negative) << 63);
  return end;
}

#endif

}  // namespace quiver::detail
