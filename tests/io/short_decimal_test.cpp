#include <quiver/core/io/text/short_decimal.h>

#include <bit>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <quiver/core/io/text/text_scanner.h>

namespace quiver {
namespace {

/// A text whose token stands where shortDecimal() may look around it.
std::string framed(const std::string& token, char after) {
  return std::string(20, '7') + ' ' + token + after + std::string(20, '3');
}

std::vector<double> shortReals(const std::string& text, std::size_t from, std::size_t most) {
  std::vector<double> values(most);
  TextScanner scanner(std::string_view(text).substr(from));
  const char* last = nullptr;
  values.resize(scanner.shortReals(text.data(), values, last));
  return values;
}

#ifdef __SSE2__

/// The end's distance from the token's start and the value's bits; −1 if the token is refused.
std::pair<std::ptrdiff_t, std::uint64_t> readShort(const std::string& token, char after = ' ') {
  const std::string text = framed(token, after);
  const char* const place = text.data() + 21;
  double value = 0.0;
  const char* const end = detail::shortDecimal(place, value);
  return end ? std::pair(end - place, std::bit_cast<std::uint64_t>(value))
             : std::pair(std::ptrdiff_t{-1}, std::uint64_t{0});
}

void expectLikeParseReal(const std::string& token) {
  const ParsedNumber<double> expected = parseReal(token.data(), token.data() + token.size());
  const auto [length, bits] = readShort(token);
  ASSERT_EQ(length, static_cast<std::ptrdiff_t>(token.size())) << token;
  ASSERT_EQ(bits, std::bit_cast<std::uint64_t>(expected.value)) << token;
}

TEST(ShortDecimal, AgreesWithParseRealOnRandomTokens) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 200000; ++i) {
    std::string token(1 + random() % 14, '0');
    for (char& c : token) c = static_cast<char>('0' + random() % 10);
    if (token.size() > 1 && random() % 4) token[random() % token.size()] = '.';
    if (random() % 2) token.insert(token.begin(), '-');
    expectLikeParseReal(token);
  }
}

TEST(ShortDecimal, ReadsEveryPlaceOfThePoint) {
  for (std::size_t length = 1; length <= 14; ++length) {
    const std::string digits = std::string("98765432109876").substr(0, length);
    for (const char* sign : {"", "-"}) {
      expectLikeParseReal(sign + digits);
      for (std::size_t point = 0; point <= length && length < 14; ++point)
        expectLikeParseReal(sign + digits.substr(0, point) + "." + digits.substr(point));
    }
  }
  expectLikeParseReal("-0");
  expectLikeParseReal("-0.000000");
}

TEST(ShortDecimal, TakesEveryBlankAndTheEndOfALine) {
  for (const char after : {' ', '\t', '\r', '\n'}) EXPECT_EQ(readShort("12.5", after).first, 4) << int{after};
}

TEST(ShortDecimal, LeavesOtherFormsToOthers) {
  for (const char* token : {"", "-", ".", "-.", "+1", "1e5", "1-2", "--1", "1.2.3", "..", "nan", "inf", "1,5", "0x10",
                            "1\x01", "1\x80", "12345678901234567890", "0.12345678901234567"}) {
    EXPECT_EQ(readShort(token).first, -1) << token;
  }
  EXPECT_EQ(readShort("1", '\0').first, -1);
  EXPECT_EQ(readShort("1", '\v').first, -1);
}

#endif

TEST(ShortReals, StopAtWhatIsNotShort) {
  const std::string text = "VERTEX_OF_A_LONG_NAME 0.5  -2\t3e0 4 and a rest of more than sixteen bytes";
  const std::vector<double> values = shortReals(text, 21, 9);
#ifdef __SSE2__
  EXPECT_EQ(values, (std::vector<double>{0.5, -2.0}));
#else
  EXPECT_TRUE(values.empty());
#endif
}

TEST(ShortReals, ReadNoMoreThanAskedForAndNotNearTheEnds) {
  const std::string text = "VERTEX_OF_A_LONG_NAME 1 2 3 4 5 6 7 8 9";
  EXPECT_LE(shortReals(text, 21, 2).size(), 2u);
  EXPECT_TRUE(shortReals(text, 30, 9).empty());
  EXPECT_TRUE(shortReals("A 1 2 3 4 5 6 7 8 9 10 11 12 13", 1, 9).empty());
}

}  // namespace
}  // namespace quiver
