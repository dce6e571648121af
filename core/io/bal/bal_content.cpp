#include <quiver/core/io/bal/bal_content.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include <quiver/core/io/text/text_scanner.h>
#include <quiver/core/util/parallel.h>

namespace quiver::detail {
namespace {

struct BalHeader {
  std::int64_t cameras = 0;
  std::int64_t points = 0;
  std::int64_t observations = 0;
  /// The first byte behind it.
  const char* end = nullptr;
};

/// Numbers separated by any blanks and line ends.
class BalScanner {
 public:
  BalScanner(const SourceText& source, const char* begin)
      : source_(source), scanner_(std::string_view(begin, static_cast<std::size_t>(source.end() - begin))) {}

  const char* last() const { return last_; }
  const char* cursor() const { return scanner_.cursor(); }

  bool atEnd() {
    while (scanner_.atLineEnd()) {
      if (scanner_.atEnd()) return true;
      scanner_.nextLine();
    }
    return false;
  }

  /// `what` says which number is missing if there is none.
  template <typename What>
  double real(What what) {
    double value = 0.0;
    expect(what);
    const NumberStatus status = scanner_.real(value);
    if (status != NumberStatus::ok) throw source_.badNumber(last_, status, false);
    return value;
  }
  /// An integer from 0 to `limit` − 1.
  template <typename What>
  std::int64_t index(std::int64_t limit, What what) {
    std::int64_t value = 0;
    expect(what);
    const NumberStatus status = scanner_.integer(value);
    if (status != NumberStatus::ok) throw source_.badNumber(last_, status, true);
    if (value < 0 || value >= limit) {
      throw source_.error(last_, limit == most ? fmt::format("{} is no {}", value, what())
                                               : fmt::format("{} {} does not exist: the header promises {}, counted "
                                                             "from 0",
                                                             what(), value, limit));
    }
    return value;
  }

  static constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();

 private:
  template <typename What>
  void expect(What what) {
    if (atEnd()) throw source_.error(source_.end(), fmt::format("the file ends early: {} is missing", what()));
    last_ = scanner_.cursor();
  }

  const SourceText& source_;
  TextScanner scanner_;
  /// The number read last.
  const char* last_ = nullptr;
};

BalHeader readHeader(const SourceText& source) {
  const char* begin = source.begin();
  if (source.text.starts_with("\xef\xbb\xbf")) begin += 3;
  BalScanner scanner(source, begin);
  BalHeader header;
  header.cameras = scanner.index(BalScanner::most, [] { return "number of cameras"; });
  const char* const place = scanner.last();
  header.points = scanner.index(BalScanner::most, [] { return "number of points"; });
  header.observations = scanner.index(BalScanner::most, [] { return "number of observations"; });
  header.end = scanner.cursor();
  // Every number takes two bytes at least, itself and a blank; the last needs no blank.
  const std::int64_t numbers = BalContent::observationNumbers * header.observations +
                               BalContent::cameraNumbers * header.cameras + BalContent::pointNumbers * header.points;
  const std::int64_t left = source.end() - header.end;
  if (left < 2 * numbers) {
    throw source.error(place, fmt::format("the header promises {} cameras, {} points and {} observations, {} numbers, "
                                          "but only {} bytes follow",
                                          header.cameras, header.points, header.observations, numbers, left));
  }
  if (header.cameras + header.points == 0) throw source.error(place, "the header promises no camera and no point");
  return header;
}

BalContent sized(const BalHeader& header) {
  BalContent content;
  content.cameras = header.cameras;
  content.points = header.points;
  const auto observations = static_cast<std::size_t>(header.observations);
  content.cameraOf.resize(observations);
  content.pointOf.resize(observations);
  content.pixels.resize(2 * observations);
  content.values.resize(
      static_cast<std::size_t>(BalContent::cameraNumbers * header.cameras + BalContent::pointNumbers * header.points));
  return content;
}

/// From front to end, with an error at the first number that is wrong.
void readInOrder(const SourceText& source, const BalHeader& header, BalContent& content) {
  BalScanner scanner(source, header.end);
  for (std::size_t i = 0; i < content.cameraOf.size(); ++i) {
    const auto missing = [&](const char* what) {
      return [&, what] { return fmt::format("{} of observation {} of {}", what, i + 1, header.observations); };
    };
    content.cameraOf[i] =
        static_cast<std::int32_t>(scanner.index(header.cameras, [] { return std::string("camera"); }));
    content.pointOf[i] = static_cast<std::int32_t>(scanner.index(header.points, [] { return std::string("point"); }));
    content.pixels[2 * i] = scanner.real(missing("u"));
    content.pixels[2 * i + 1] = scanner.real(missing("v"));
  }
  for (std::size_t i = 0; i < content.values.size(); ++i) {
    content.values[i] = scanner.real([&] {
      const auto at = static_cast<std::int64_t>(i), first = BalContent::cameraNumbers * header.cameras;
      return at < first ? fmt::format("number {} of camera {}", at % BalContent::cameraNumbers + 1,
                                      at / BalContent::cameraNumbers)
                        : fmt::format("number {} of point {}", (at - first) % BalContent::pointNumbers + 1,
                                      (at - first) / BalContent::pointNumbers);
    });
  }
  if (scanner.atEnd()) return;
  throw source.error(scanner.cursor(), "the file goes on behind the last number that the header promises");
}

/// A run of whole lines and the index of its first.
struct LineRun {
  std::string_view text;
  std::int64_t first = 0;
};

std::vector<LineRun> cutIntoRuns(std::string_view text, int threads) {
  constexpr std::size_t runSize = std::size_t{1} << 18;
  std::vector<LineRun> runs;
  while (!text.empty()) {
    std::size_t size = std::min(runSize, text.size());
    const std::size_t feed = text.find('\n', size - 1);
    size = feed == std::string_view::npos ? text.size() : feed + 1;
    runs.push_back({text.substr(0, size), 0});
    text.remove_prefix(size);
  }
  std::vector<std::int64_t> lines(runs.size());
  parallelFor(static_cast<std::int64_t>(runs.size()), threads, [&](std::int64_t i) {
    const std::string_view run = runs[static_cast<std::size_t>(i)].text;
    lines[static_cast<std::size_t>(i)] = std::count(run.begin(), run.end(), '\n');
  });
  for (std::size_t i = 1; i < runs.size(); ++i) runs[i].first = runs[i - 1].first + lines[i - 1];
  return runs;
}

/// Reads one observation's or one value's line; false if it is anything else.
bool readLine(TextScanner& scanner, std::int64_t line, BalContent& content) {
  const auto observations = static_cast<std::int64_t>(content.cameraOf.size());
  if (line < observations) {
    const auto i = static_cast<std::size_t>(line);
    std::int64_t camera = 0, point = 0;
    if (scanner.integer(camera) != NumberStatus::ok || camera < 0 || camera >= content.cameras) return false;
    if (scanner.integer(point) != NumberStatus::ok || point < 0 || point >= content.points) return false;
    content.cameraOf[i] = static_cast<std::int32_t>(camera);
    content.pointOf[i] = static_cast<std::int32_t>(point);
    return scanner.real(content.pixels[2 * i]) == NumberStatus::ok &&
           scanner.real(content.pixels[2 * i + 1]) == NumberStatus::ok;
  }
  const std::int64_t value = line - observations;
  return value < static_cast<std::int64_t>(content.values.size()) &&
         scanner.real(content.values[static_cast<std::size_t>(value)]) == NumberStatus::ok;
}

/// Line by line in pieces; false if the file is not laid out that way, or holds an error.
bool readByLines(const SourceText& source, const BalHeader& header, int threads, BalContent& content) {
  TextScanner rest(std::string_view(header.end, static_cast<std::size_t>(source.end() - header.end)));
  if (!rest.atLineEnd()) return false;
  rest.nextLine();
  std::string_view text(rest.cursor(), static_cast<std::size_t>(source.end() - rest.cursor()));
  while (!text.empty() && std::string_view(" \t\r\n").find(text.back()) != std::string_view::npos)
    text.remove_suffix(1);
  const std::vector<LineRun> runs = cutIntoRuns(text, threads);
  std::vector<std::int64_t> ends(runs.size(), -1);
  parallelFor(static_cast<std::int64_t>(runs.size()), threads, [&](std::int64_t k) {
    const LineRun& run = runs[static_cast<std::size_t>(k)];
    TextScanner scanner(run.text);
    std::int64_t line = run.first;
    for (; !scanner.atEnd(); ++line) {
      if (!readLine(scanner, line, content) || !scanner.atLineEnd()) return;
      scanner.nextLine();
    }
    ends[static_cast<std::size_t>(k)] = line;
  });
  if (runs.empty() || std::find(ends.begin(), ends.end(), -1) != ends.end()) return false;
  return ends.back() == static_cast<std::int64_t>(content.cameraOf.size() + content.values.size());
}

}  // namespace

BalContent readBalContent(const SourceText& source, int threads) {
  const BalHeader header = readHeader(source);
  BalContent content = sized(header);
  if (!readByLines(source, header, threads, content)) readInOrder(source, header, content);
  return content;
}

const char* balNumberPlace(const SourceText& source, std::size_t index) {
  BalScanner scanner(source, source.begin() + (source.text.starts_with("\xef\xbb\xbf") ? 3 : 0));
  for (std::size_t i = 0; i <= index; ++i) scanner.real([] { return "a number"; });
  return scanner.last();
}

}  // namespace quiver::detail
