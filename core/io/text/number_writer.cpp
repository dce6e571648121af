#include <array>
#include <charconv>

#include <quiver/core/io/text/number_writer.h>

namespace quiver {

void NumberWriter::real(double value) {
  std::array<char, 32> digits;  // the longest is -2.2250738585072014e-308
  const std::to_chars_result result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text_.append(digits.data(), result.ptr);
}

void NumberWriter::integer(std::int64_t value) {
  std::array<char, 24> digits;
  const std::to_chars_result result = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text_.append(digits.data(), result.ptr);
}

}  // namespace quiver
