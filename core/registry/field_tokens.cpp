#include <quiver/core/registry/field_tokens.h>

#include <bit>

#include <quiver/core/util/error.h>

namespace quiver::detail {

bool FieldToken::same(const FieldToken& other) const {
  return kind == other.kind && std::bit_cast<std::uint64_t>(real) == std::bit_cast<std::uint64_t>(other.real) &&
         integer == other.integer && word == other.word;
}

const FieldToken& TokenReader::take(const char* what) {
  if (atEnd()) fail(std::string("the line ends where ") + what + " is wanted");
  return tokens_[next_++];
}

double TokenReader::real() {
  const FieldToken& token = take("a number");
  if (token.kind == FieldToken::Kind::word) fail("a word stands where a number is wanted");
  return token.kind == FieldToken::Kind::real ? token.real : static_cast<double>(token.integer);
}

std::int64_t TokenReader::integer() {
  const FieldToken& token = take("an integer");
  if (token.kind != FieldToken::Kind::integer) fail("something else stands where an integer is wanted");
  return token.integer;
}

std::string_view TokenReader::word() {
  const FieldToken& token = take("a word");
  if (token.kind != FieldToken::Kind::word) fail("a number stands where a word is wanted");
  return token.word;
}

void TokenReader::fail(const std::string& message) const { throw ParseError("", 0, 0, message); }

double RandomReader::real() {
  const Field field = next_ < fields_.size() ? fields_[next_] : Field{};
  ++next_;
  const std::string& name = field.name;
  if (name.size() == 3 && name[0] == 'I' && name[1] >= '1' && name[1] <= '9' && name[2] >= '1' && name[2] <= '9') {
    return name[1] == name[2] ? uniform(random_, 1.0, 2.0) : uniform(random_, -0.1, 0.1);
  }
  if (name == "scale") return uniform(random_, 0.5, 2.0);
  return field.unit == "rad" ? uniform(random_, -3.0, 3.0) : uniform(random_, -2.0, 2.0);
}

std::int64_t RandomReader::integer() {
  ++next_;
  return count_;
}

std::string_view RandomReader::word() {
  ++next_;
  return "word";
}

void RandomReader::fail(const std::string& message) const { throw ParseError("", 0, 0, message); }

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}

}  // namespace quiver::detail
