#include <quiver/core/io/toro/bearing_range.h>

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

}  // namespace quiver::detail
