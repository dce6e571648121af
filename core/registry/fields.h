#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quiver {

/// One number of a file's line: its name, its unit ("m", "rad", "" for none) and, where the name does not say it, its
/// meaning.
struct Field {
  std::string name;
  std::string unit;
  std::string documentation;
};

/// The numbers of one element's line, read from left to right. Every function throws ParseError with the place of the
/// trouble.
class FieldReader {
 public:
  virtual ~FieldReader() = default;
  /// The next token as a finite number.
  virtual double real() = 0;
  virtual std::int64_t integer() = 0;
  virtual std::string_view word() = 0;
  /// Fills `out` with the next out.size() numbers.
  virtual void reals(std::span<double> out) {
    for (double& value : out) value = real();
  }
  /// Whether the line has no further token.
  virtual bool atEnd() = 0;
  /// Throws ParseError at the token read last.
  [[noreturn]] virtual void fail(const std::string& message) const = 0;
};

/// Writes the numbers of one element's line; reals with the shortest digits that read back to the same bits.
class FieldWriter {
 public:
  virtual ~FieldWriter() = default;
  virtual void real(double value) = 0;
  virtual void integer(std::int64_t value) = 0;
  virtual void word(std::string_view value) = 0;
  virtual void reals(std::span<const double> values) {
    for (const double value : values) real(value);
  }
};

}  // namespace quiver
