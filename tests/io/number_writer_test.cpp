#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <quiver/core/io/text/number_writer.h>

namespace quiver {
namespace {

std::string written(double value) {
  NumberWriter writer;
  writer.real(value);
  return std::string(writer.view());
}

TEST(NumberWriter, WritesTheShortestDigits) {
  EXPECT_EQ(written(0.0), "0");
  EXPECT_EQ(written(-0.0), "-0");
  EXPECT_EQ(written(0.1), "0.1");
  EXPECT_EQ(written(1e22), "1e+22");
  EXPECT_EQ(written(-1.0 / 3.0), "-0.3333333333333333");
  EXPECT_EQ(written(std::numeric_limits<double>::max()), "1.7976931348623157e+308");
  EXPECT_EQ(written(std::numeric_limits<double>::denorm_min()), "5e-324");
  EXPECT_EQ(written(-2.2250738585072014e-308), "-2.2250738585072014e-308");
}

TEST(NumberWriter, ReadsBackByStrtod) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  for (int i = 0; i < 300'000; ++i) {
    const double value = std::ldexp(mantissa(random), static_cast<int>(random() % 120) - 60);
    ASSERT_EQ(std::strtod(written(value).c_str(), nullptr), value);
  }
}

TEST(NumberWriter, MixesNumbersAndText) {
  NumberWriter writer;
  writer.text("EDGE");
  writer.character(' ');
  writer.integer(std::numeric_limits<std::int64_t>::min());
  writer.character(' ');
  writer.integer(7);
  EXPECT_EQ(writer.view(), "EDGE -9223372036854775808 7");
  EXPECT_EQ(writer.size(), writer.view().size());
  writer.clear();
  EXPECT_EQ(writer.view(), "");
}

}  // namespace
}  // namespace quiver
