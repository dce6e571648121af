#include <quiver/core/io/g2o/g2o_field_reader.h>

#include <fmt/format.h>

namespace quiver::detail {
namespace {

/// n such that n (n + 1) / 2 = entries, or −1.
int triangleDimension(std::size_t entries) {
  std::size_t n = 0;
  while (n * (n + 1) / 2 < entries) ++n;
  return n * (n + 1) / 2 == entries ? static_cast<int>(n) : -1;
}

}  // namespace

G2oFieldReader::G2oFieldReader(const SourceText& source, const ElementType& type, const char* line, const char* fields)
    : source_(source),
      type_(type),
      line_(line),
      fields_(fields),
      last_(fields),
      scanner_(std::string_view(fields, static_cast<std::size_t>(source.end() - fields))) {}

double G2oFieldReader::nextReal() {
  scanner_.atLineEnd();
  last_ = scanner_.cursor();
  double value = 0.0;
  const NumberStatus status = scanner_.real(value);
  if (status != NumberStatus::ok) failNumber(status, false);
  return value;
}

double G2oFieldReader::real() {
  double value = 0.0;
  reals({&value, 1});
  return value;
}

void G2oFieldReader::reals(std::span<double> out) {
  std::size_t done = scanner_.shortReals(source_.begin(), out, last_);
  while (done < out.size()) {
    out[done++] = nextReal();
    done += scanner_.shortReals(source_.begin(), out.subspan(done), last_);
  }
}

std::int64_t G2oFieldReader::integer() {
  scanner_.atLineEnd();
  last_ = scanner_.cursor();
  std::int64_t value = 0;
  const NumberStatus status = scanner_.integer(value);
  if (status != NumberStatus::ok) failNumber(status, true);
  return value;
}

std::string_view G2oFieldReader::word() {
  if (scanner_.atLineEnd()) failEarly();
  const std::string_view token = scanner_.token();
  last_ = token.data();
  if (const char* binary = findBinary(token)) throw source_.error(binary, "binary data");
  return token;
}

void G2oFieldReader::fail(const std::string& message) const { throw source_.error(last_, message); }

std::string_view G2oFieldReader::tag() const {
  return *line_ == '#' ? std::string_view(type_.tag()) : source_.tokenAt(line_);
}

void G2oFieldReader::failNumber(NumberStatus status, bool integer) {
  if (scanner_.atLineEnd()) failEarly();
  throw source_.badNumber(last_, status, integer);
}

/// Names the field that is missing, as the type documents its fields.
void G2oFieldReader::failEarly() {
  const char* const from = information_ ? information_ : fields_;
  TextScanner counter(std::string_view(from, static_cast<std::size_t>(source_.end() - from)));
  std::size_t read = 0;
  while (!counter.token().empty()) ++read;
  if (information_) {
    const auto entries = static_cast<std::size_t>(informationDimension_ * (informationDimension_ + 1) / 2);
    const std::vector<Field> tail = type_.tailFields();
    if (read >= entries && read - entries < tail.size()) {
      throw source_.endsEarly(from, fmt::format("field '{}' of {}, behind the information matrix, is missing",
                                                tail[read - entries].name, tag()));
    }
    int row = 0;
    int column = static_cast<int>(read);
    for (; column >= informationDimension_ - row; ++row) column -= informationDimension_ - row;
    throw source_.endsEarly(
        from, fmt::format("entry ({}, {}) of the information matrix is missing", row + 1, row + column + 1));
  }
  const std::vector<Field> fields = type_.fields();
  throw source_.endsEarly(from, read < fields.size()
                                    ? fmt::format("field '{}' of {} is missing", fields[read].name, tag())
                                    : fmt::format("{} has further fields", tag()));
}

int G2oFieldReader::information(int dimension, std::vector<double>& triangle) {
  scanner_.atLineEnd();
  information_ = scanner_.cursor();
  if (dimension > 0) {
    informationDimension_ = dimension;
    triangle.resize(static_cast<std::size_t>(dimension) * static_cast<std::size_t>(dimension + 1) / 2);
    reals(triangle);
    return dimension;
  }
  triangle.clear();
  while (!atEnd()) triangle.push_back(nextReal());
  const int found = triangleDimension(triangle.size());
  if (found <= 0) {
    throw source_.error(information_,
                        fmt::format("{} numbers are no upper triangle of an information matrix: 1, 3, 6, 10 … would be",
                                    triangle.size()));
  }
  return found;
}

bool G2oFieldReader::skipInformation(int dimension, std::string_view text) {
  scanner_.atLineEnd();
  const char* const place = scanner_.cursor();
  if (!scanner_.skipToken(text)) return false;
  information_ = place;
  informationDimension_ = dimension;
  return true;
}

void G2oFieldReader::expectEnd() {
  if (atEnd()) return;
  const std::string_view extra = scanner_.token();
  throw source_.error(extra.data(), fmt::format("unexpected {} after the last field of {}", quoted(extra), tag()));
}

}  // namespace quiver::detail
