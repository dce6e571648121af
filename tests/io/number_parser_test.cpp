#include <bit>
#include <charconv>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <quiver/core/io/text/number_parser.h>
#include <quiver/core/io/text/number_writer.h>

namespace quiver {
namespace {

ParsedNumber<double> real(const std::string& text) { return parseReal(text.data(), text.data() + text.size()); }
ParsedNumber<std::int64_t> integer(const std::string& text) {
  return parseInteger(text.data(), text.data() + text.size());
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// Reads `text` by strtod, which takes the same decimal numbers, and compares value and end.
void expectLikeStrtod(const std::string& text) {
  char* end = nullptr;
  const double expected = std::strtod(text.c_str(), &end);
  const ParsedNumber<double> parsed = real(text);
  ASSERT_EQ(parsed.end - text.data(), end - text.c_str()) << text;
  if (std::isinf(expected)) {
    ASSERT_EQ(parsed.status, NumberStatus::outOfRange) << text;
  } else if (end == text.c_str()) {
    ASSERT_EQ(parsed.status, NumberStatus::notANumber) << text;
  } else {
    ASSERT_EQ(parsed.status, NumberStatus::ok) << text;
    ASSERT_EQ(bits(parsed.value), bits(expected)) << text;
  }
}

std::string randomDigits(std::mt19937_64& random, int most) {
  std::string digits(std::uniform_int_distribution<std::size_t>(0, static_cast<std::size_t>(most))(random), '0');
  const bool mostlyZero = random() % 8 == 0;
  for (char& c : digits) c = mostlyZero && random() % 4 ? '0' : static_cast<char>('0' + random() % 10);
  return digits;
}

std::string randomToken(std::mt19937_64& random) {
  constexpr const char* signs[] = {"", "", "-", "+"};
  const int most = random() % 4 == 0 ? 40 : 12;
  std::string token = signs[random() % 4] + randomDigits(random, most);
  if (random() % 4) token += "." + randomDigits(random, most);
  if (random() % 3 == 0)
    token += (random() % 2 ? "e" : "E") + std::string(signs[random() % 4]) + randomDigits(random, 3);
  if (random() % 8 == 0) token += "x";
  return token;
}

TEST(ParseReal, AgreesWithStrtodOnRandomTokens) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2'000'000; ++i) {
    const std::string token = randomToken(random);
    // "1e+" and its like: strtod and this parser both stop before the exponent.
    ASSERT_NO_FATAL_FAILURE(expectLikeStrtod(token));
  }
}

TEST(ParseReal, ReadsShortestDigitsBackToTheSameBits) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 1'000'000; ++i) {
    const auto value = std::bit_cast<double>(static_cast<std::uint64_t>(random()));
    if (!std::isfinite(value)) continue;
    NumberWriter writer;
    writer.real(value);
    const ParsedNumber<double> parsed = real(std::string(writer.view()));
    ASSERT_EQ(parsed.status, NumberStatus::ok) << writer.view();
    ASSERT_EQ(bits(parsed.value), bits(value)) << writer.view();
  }
}

TEST(ParseReal, AgreesWithFromCharsAroundTheFastPath) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 500'000; ++i) {
    const std::uint64_t mantissa = (std::uint64_t{1} << 53) - 1000 + random() % 2000;
    const int exponent = static_cast<int>(random() % 56) - 28;
    const std::string token = std::to_string(mantissa) + "e" + std::to_string(exponent);
    double expected = 0.0;
    std::from_chars(token.data(), token.data() + token.size(), expected);
    ASSERT_EQ(bits(real(token).value), bits(expected)) << token;
  }
}

TEST(ParseReal, RoundsHalvesToEven) {
  for (const char* token :
       {"9007199254740993", "9007199254740993.0", "9007199254740993.00000000000000000000000000000000000001",
        "9007199254740995", "0.500000000000000166533453693773481063544750213623046875",
        "1.00000000000000011102230246251565", "2.2250738585072011e-308", "2.2250738585072012e-308",
        "4.9406564584124654e-324", "2.4703282292062328e-324", "2.4703282292062327e-324", "1.7976931348623157e308",
        "1.7976931348623158e308"}) {
    ASSERT_NO_FATAL_FAILURE(expectLikeStrtod(token));
  }
}

TEST(ParseReal, ReadsSignsPointsAndExponents) {
  EXPECT_EQ(real("+5").value, 5.0);
  EXPECT_EQ(real(".5").value, 0.5);
  EXPECT_EQ(real("5.").value, 5.0);
  EXPECT_EQ(real("-1.5E+2").value, -150.0);
  EXPECT_EQ(bits(real("-0").value), bits(-0.0));
  EXPECT_EQ(bits(real("-0.000").value), bits(-0.0));
  EXPECT_EQ(real("1e").end[0], 'e');
  EXPECT_EQ(real("1e+").value, 1.0);
  EXPECT_EQ(real("0x10").end[0], 'x');
}

TEST(ParseReal, RefusesWhatIsNoNumber) {
  for (const char* token : {"", "-", "+", ".", "-.", "e5", ".e5", "+-5", "-+5", "--5", "++5", "x", " 5", "na", "in"}) {
    const std::string text = token;
    const ParsedNumber<double> parsed = real(text);
    EXPECT_EQ(parsed.status, NumberStatus::notANumber) << text;
    EXPECT_EQ(parsed.end, text.data()) << text;
    EXPECT_EQ(parsed.value, 0.0) << text;
  }
}

TEST(ParseReal, ReportsNanAndInfinity) {
  for (const char* token :
       {"nan", "-nan", "NaN", "nan(ind)", "-nan(0x8)", "inf", "+inf", "-INF", "Infinity", "-infinity"}) {
    const std::string text = token;
    const ParsedNumber<double> parsed = real(text);
    EXPECT_EQ(parsed.status, NumberStatus::notFinite) << text;
    EXPECT_EQ(parsed.end, text.data() + text.size()) << text;
  }
}

TEST(ParseReal, OverflowIsAnErrorAndUnderflowIsZero) {
  const std::string zeros(400, '0');
  for (const std::string& token :
       {std::string("1e309"), std::string("-1e309"), "1" + zeros, "1" + zeros + ".5",
        std::string("1e99999999999999999999"), "0." + zeros + "1e800", std::string("1.8e308")}) {
    EXPECT_EQ(real(token).status, NumberStatus::outOfRange) << token;
    EXPECT_EQ(*real(token).end, '\0') << token;
  }
  for (const std::string& token : {std::string("1e-400"), "0." + zeros + "1", std::string("1e-99999999999999999999"),
                                   "1" + zeros + "e-1000", std::string("2e-324")}) {
    EXPECT_EQ(real(token).status, NumberStatus::ok) << token;
    EXPECT_EQ(bits(real(token).value), bits(0.0)) << token;
    EXPECT_EQ(bits(real("-" + token).value), bits(-0.0)) << token;
  }
  EXPECT_EQ(real("1" + zeros + "e-400").value, 1.0);
  EXPECT_EQ(real("0." + zeros + "1e401").value, 1.0);
}

TEST(ParseReal, ReadsAMegabyteOfDigits) {
  const std::string digits(1'000'000, '7');
  EXPECT_EQ(real(digits).status, NumberStatus::outOfRange);
  EXPECT_EQ(real("0." + digits).value, std::strtod(("0." + digits).c_str(), nullptr));
}

TEST(ParseReal, DoesNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  const bool german = std::setlocale(LC_NUMERIC, "de_DE.UTF-8") || std::setlocale(LC_NUMERIC, "de_DE");
  EXPECT_EQ(real("1.5").value, 1.5);
  EXPECT_EQ(real("1.50000000000000000000000000001").value, 1.5);
  EXPECT_EQ(*real("1,5").end, ',');
  NumberWriter writer;
  writer.real(1234567.5);
  EXPECT_EQ(writer.view(), "1234567.5");
  std::setlocale(LC_NUMERIC, before.c_str());
  if (!german) GTEST_SKIP() << "no German locale here; checked in locale " << before;
}

TEST(ParseInteger, ReadsTheWholeRange) {
  EXPECT_EQ(integer("0").value, 0);
  EXPECT_EQ(integer("-0").value, 0);
  EXPECT_EQ(integer("+17").value, 17);
  EXPECT_EQ(integer("000000000000000000000000017").value, 17);
  EXPECT_EQ(integer("9223372036854775807").value, std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(integer("-9223372036854775808").value, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(integer("999999999999999999").value, 999999999999999999);
  EXPECT_EQ(*integer("12.5").end, '.');
}

TEST(ParseInteger, RefusesTheRest) {
  for (const char* token : {"", "-", "+", "+-1", "-+1", "x", ".5", " 1"}) {
    EXPECT_EQ(integer(token).status, NumberStatus::notANumber) << token;
  }
  for (const char* token : {"9223372036854775808", "-9223372036854775809", "99999999999999999999999999"}) {
    EXPECT_EQ(integer(token).status, NumberStatus::outOfRange) << token;
    EXPECT_EQ(*integer(token).end, '\0') << token;
  }
}

TEST(ParseInteger, AgreesWithFromCharsOnRandomTokens) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 500'000; ++i) {
    const std::string token = (random() % 2 ? "-" : "") + randomDigits(random, 22);
    std::int64_t expected = 0;
    const auto result = std::from_chars(token.data(), token.data() + token.size(), expected);
    const ParsedNumber<std::int64_t> parsed = integer(token);
    ASSERT_EQ(parsed.status == NumberStatus::ok, result.ec == std::errc()) << token;
    if (parsed.status == NumberStatus::ok) {
      ASSERT_EQ(parsed.value, expected) << token;
    }
    ASSERT_EQ(parsed.end, result.ptr) << token;
  }
}

}  // namespace
}  // namespace quiver
