#include <string>

#include <gtest/gtest.h>

#include <quiver/core/io/text/text_scanner.h>

namespace quiver {
namespace {

TEST(TextScanner, SplitsALineIntoTokens) {
  const std::string text = "  VERTEX\t1  2.5\r\nNEXT";
  TextScanner scanner(text);
  EXPECT_EQ(scanner.token(), "VERTEX");
  std::int64_t id = 0;
  EXPECT_EQ(scanner.integer(id), NumberStatus::ok);
  EXPECT_EQ(id, 1);
  EXPECT_FALSE(scanner.atLineEnd());
  double value = 0.0;
  EXPECT_EQ(scanner.real(value), NumberStatus::ok);
  EXPECT_EQ(value, 2.5);
  EXPECT_TRUE(scanner.atLineEnd());
  EXPECT_EQ(scanner.token(), "");
  EXPECT_EQ(scanner.real(value), NumberStatus::notANumber);
  EXPECT_EQ(scanner.nextLine(), "");
  EXPECT_EQ(scanner.nextLine(), "NEXT");
  EXPECT_TRUE(scanner.atEnd());
  EXPECT_EQ(scanner.nextLine(), "");
}

TEST(TextScanner, StaysBeforeWhatIsNoNumber) {
  const std::string text = "1.5x nan 1e999 1.5 9223372036854775808";
  TextScanner scanner(text);
  double value = -1.0;
  std::int64_t id = -1;
  EXPECT_EQ(scanner.real(value), NumberStatus::notANumber);
  EXPECT_EQ(scanner.token(), "1.5x");
  EXPECT_EQ(scanner.real(value), NumberStatus::notFinite);
  EXPECT_EQ(scanner.token(), "nan");
  EXPECT_EQ(scanner.real(value), NumberStatus::outOfRange);
  EXPECT_EQ(scanner.token(), "1e999");
  EXPECT_EQ(scanner.integer(id), NumberStatus::notANumber);
  EXPECT_EQ(scanner.token(), "1.5");
  EXPECT_EQ(scanner.integer(id), NumberStatus::outOfRange);
  EXPECT_EQ(value, -1.0);
  EXPECT_EQ(id, -1);
}

TEST(TextScanner, DoesNotReadBeyondTheEnd) {
  const std::string text = "12345";
  TextScanner scanner(std::string_view(text).substr(0, 3));
  double value = 0.0;
  EXPECT_EQ(scanner.real(value), NumberStatus::ok);
  EXPECT_EQ(value, 123.0);
  TextScanner empty{std::string_view()};
  EXPECT_TRUE(empty.atLineEnd());
  EXPECT_EQ(empty.nextLine(), "");
}

TEST(TextScanner, SkipsATokenThatIsKnown) {
  const std::string text = "TAG 1 2 33\nTAGS TAG";
  TextScanner scanner(text);
  EXPECT_FALSE(scanner.skipToken(""));
  EXPECT_FALSE(scanner.skipToken("TA"));
  EXPECT_FALSE(scanner.skipToken("TAG 1 2 3"));
  EXPECT_TRUE(scanner.skipToken("TAG 1 2"));
  EXPECT_EQ(scanner.token(), "33");
  scanner.nextLine();
  EXPECT_FALSE(scanner.skipToken("TAG"));
  EXPECT_EQ(scanner.token(), "TAGS");
  scanner.atLineEnd();
  EXPECT_FALSE(scanner.skipToken("TAG1"));
  EXPECT_TRUE(scanner.skipToken("TAG"));
  EXPECT_TRUE(scanner.atEnd());
}

TEST(TextScanner, LocatesPlaces) {
  const std::string text = "a\n\nbc d\n";
  const auto at = [&](std::size_t offset) {
    const TextPosition position = locate(text, text.data() + offset);
    return std::pair(position.line, position.column);
  };
  EXPECT_EQ(at(0), std::pair(std::int64_t{1}, std::int64_t{1}));
  EXPECT_EQ(at(1), std::pair(std::int64_t{1}, std::int64_t{2}));
  EXPECT_EQ(at(2), std::pair(std::int64_t{2}, std::int64_t{1}));
  EXPECT_EQ(at(6), std::pair(std::int64_t{3}, std::int64_t{4}));
  EXPECT_EQ(at(8), std::pair(std::int64_t{4}, std::int64_t{1}));
}

TEST(TextScanner, FindsBinaryBytes) {
  EXPECT_EQ(findBinary("plain\ttext\r\n \xc3\xa4"), nullptr);
  const std::string text("ab\0c", 4);
  EXPECT_EQ(findBinary(text), text.data() + 2);
  EXPECT_TRUE(isBinary('\x1b'));
  EXPECT_TRUE(isBinary('\x7f'));
}

}  // namespace
}  // namespace quiver
