#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace quiver {

/// Text in a growing buffer. Numbers do not depend on the locale.
class NumberWriter {
 public:
  /// The shortest digits that read back to the same bits: "0.1", "-0", "1e-07", "1.7976931348623157e+308". Values that
  /// are not finite come out as "inf", "-inf", "nan" and "-nan", which no reader of quiver takes.
  void real(double value);
  void integer(std::int64_t value);
  void character(char c) { text_.push_back(c); }
  void text(std::string_view text) { text_.append(text); }

  std::string_view view() const { return text_; }
  std::size_t size() const { return text_.size(); }
  /// Forgets the text and keeps the memory.
  void clear() { text_.clear(); }

 private:
  std::string text_;
};

}  // namespace quiver
