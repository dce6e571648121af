#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <quiver/core/io/text/source_text.h>
#include <quiver/core/io/text/text_scanner.h>
#include <quiver/core/registry/element_types.h>

namespace quiver::detail {

/// Reads the fields of one element's line, then its information matrix, and finds fault with what is missing or too
/// much.
class G2oFieldReader final : public FieldReader {
 public:
  /// `line` is where the line of an element of this type starts, `fields` where its fields do, or the blanks before
  /// them.
  G2oFieldReader(const SourceText& source, const ElementType& type, const char* line, const char* fields);

  double real() override;
  std::int64_t integer() override;
  std::string_view word() override;
  void reals(std::span<double> out) override;
  bool atEnd() override { return scanner_.atLineEnd(); }
  [[noreturn]] void fail(const std::string& message) const override;

  /// Reads the upper triangle of an information matrix. With `dimension` > 0 exactly that, otherwise the rest of the
  /// line; then the number of entries must be that of a triangle. Returns the dimension.
  int information(int dimension, std::vector<double>& triangle);
  /// Moves behind the information matrix if its text is the given one (not empty), letter by letter.
  bool skipInformation(int dimension, std::string_view text);
  /// The information matrix read last, as text.
  std::string_view informationText() const {
    return {information_, static_cast<std::size_t>(scanner_.cursor() - information_)};
  }
  /// The first token of the information matrix.
  const char* informationPlace() const { return information_; }
  /// Throws ParseError unless the line has no further token.
  void expectEnd();

 private:
  double nextReal();
  [[noreturn]] void failNumber(NumberStatus status, bool integer);
  [[noreturn]] void failEarly();
  /// As the line spells it.
  std::string_view tag() const;

  const SourceText& source_;
  const ElementType& type_;
  const char* line_;
  const char* fields_;
  const char* information_ = nullptr;
  int informationDimension_ = 0;
  /// The token read last.
  const char* last_;
  TextScanner scanner_;
};

}  // namespace quiver::detail
