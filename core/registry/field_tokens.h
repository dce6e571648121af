#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include <quiver/core/registry/fields.h>

namespace quiver::detail {

/// One number or word of a line.
struct FieldToken {
  enum class Kind { real, integer, word };
  Kind kind = Kind::real;
  double real = 0.0;
  std::int64_t integer = 0;
  std::string word;

  /// The same bits: −0 differs from 0.
  bool same(const FieldToken& other) const;
};

/// Keeps what an element writes.
class TokenWriter final : public FieldWriter {
 public:
  void real(double value) override { tokens_.push_back({FieldToken::Kind::real, value, 0, {}}); }
  void integer(std::int64_t value) override { tokens_.push_back({FieldToken::Kind::integer, 0.0, value, {}}); }
  void word(std::string_view value) override {
    tokens_.push_back({FieldToken::Kind::word, 0.0, 0, std::string(value)});
  }
  const std::vector<FieldToken>& tokens() const { return tokens_; }

 private:
  std::vector<FieldToken> tokens_;
};

/// Gives tokens to an element that reads them.
class TokenReader final : public FieldReader {
 public:
  explicit TokenReader(const std::vector<FieldToken>& tokens) : tokens_(tokens) {}
  double real() override;
  std::int64_t integer() override;
  std::string_view word() override;
  bool atEnd() override { return next_ == tokens_.size(); }
  [[noreturn]] void fail(const std::string& message) const override;

 private:
  const FieldToken& take(const char* what);

  const std::vector<FieldToken>& tokens_;
  std::size_t next_ = 0;
};

/// Makes up a line for an element: numbers within ±2, angles ("rad") within ±3, what is named "scale" positive, every
/// integer `count`; fields named I11, I12 … I66 are a positive definite information matrix.
class RandomReader final : public FieldReader {
 public:
  RandomReader(std::mt19937_64& random, std::vector<Field> fields, std::int64_t count)
      : random_(random), fields_(std::move(fields)), count_(count) {}
  double real() override;
  std::int64_t integer() override;
  std::string_view word() override;
  bool atEnd() override { return false; }
  [[noreturn]] void fail(const std::string& message) const override;

 private:
  std::mt19937_64& random_;
  std::vector<Field> fields_;
  std::int64_t count_;
  std::size_t next_ = 0;
};

/// A number in [low, high), the same on every platform.
double uniform(std::mt19937_64& random, double low, double high);

}  // namespace quiver::detail
