#include <quiver/core/io/toro/bearing_range.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <quiver/core/util/error.h>

namespace quiver::detail {
namespace {

/// Hands out numbers that were computed, and blames the line they came from.
class ComputedFields final : public FieldReader {
 public:
  ComputedFields(std::span<const double> values, const FieldReader& line) : values_(values), line_(line) {}

  double real() override {
    if (values_.empty()) fail("this type is not a point seen from a pose");
    const double value = values_.front();
    values_ = values_.subspan(1);
    return value;
  }
  std::int64_t integer() override { fail("this type is not a point seen from a pose"); }
  std::string_view word() override { fail("this type is not a point seen from a pose"); }
  bool atEnd() override { return values_.empty(); }
  [[noreturn]] void fail(const std::string& message) const override {
    line_.fail(message);
    throw LogicError("FieldReader::fail returned");
  }

 private:
  std::span<const double> values_;
  const FieldReader& line_;
};

/// Keeps the two numbers of a place.
class PlaceWriter final : public FieldWriter {
 public:
  void real(double value) override {
    if (count < 2) place[count] = value;
    ++count;
  }
  void integer(std::int64_t) override { count = 3; }
  void word(std::string_view) override { count = 3; }

  std::array<double, 2> place{};
  std::size_t count = 0;
};

double positive(FieldReader& reader, const char* message) {
  const double value = reader.real();
  if (!(value > 0.0)) reader.fail(message);
  return value;
}

}  // namespace

void readBearingRange(const EdgeType& type, FieldReader& reader, Edge& edge) {
  const double bearing = reader.real();
  const double range = positive(reader, "a range is positive");
  const double bearingDeviation = positive(reader, "a standard deviation is positive");
  const double rangeDeviation = positive(reader, "a standard deviation is positive");
  const double c = std::cos(bearing);
  const double s = std::sin(bearing);
  const std::array<double, 2> place{range * c, range * s};
  ComputedFields fields(place, reader);
  type.read(fields, edge);
  const double along = 1.0 / (rangeDeviation * rangeDeviation);
  const double across = 1.0 / (range * range * bearingDeviation * bearingDeviation);
  const std::array<double, 3> information{along * c * c + across * s * s, (along - across) * c * s,
                                          along * s * s + across * c * c};
  for (const double value : information) {
    if (!std::isfinite(value)) reader.fail("these standard deviations give an infinite information");
  }
  type.setInformation(edge, information);
}

std::optional<BearingRange> bearingRangeOf(const EdgeType& type, const Edge& edge) {
  PlaceWriter writer;
  type.write(edge, writer);
  const std::span<const double> I = type.information(edge);
  const double range = std::hypot(writer.place[0], writer.place[1]);
  if (writer.count != 2 || I.size() != 3 || !(range > 0.0)) return std::nullopt;
  const double c = writer.place[0] / range;
  const double s = writer.place[1] / range;
  const double along = I[0] * c * c + 2.0 * I[1] * c * s + I[2] * s * s;
  const double across = I[0] * s * s - 2.0 * I[1] * c * s + I[2] * c * c;
  const double mixed = (I[2] - I[0]) * c * s + I[1] * (c * c - s * s);
  constexpr double rounding = 1e-9;
  if (!(along > 0.0) || !(across > 0.0) || std::abs(mixed) > rounding * std::max(along, across)) return std::nullopt;
  return BearingRange{std::atan2(writer.place[1], writer.place[0]), range, 1.0 / (range * std::sqrt(across)),
                      1.0 / std::sqrt(along)};
}

}  // namespace quiver::detail
