#pragma once

#include <cstdint>
#include <vector>

#include <quiver/core/io/text/source_text.h>

namespace quiver::detail {

/// The numbers of a file of "bundle adjustment in the large", whose text is
///
///     cameras points observations
///     camera point u v                        once an observation
///     nine numbers a camera, then three a point
///
/// with any blanks and line ends between numbers.
struct BalContent {
  std::int64_t cameras = 0;
  std::int64_t points = 0;
  /// Indices, one of each an observation.
  std::vector<std::int32_t> cameraOf;
  std::vector<std::int32_t> pointOf;
  /// u, v of the observations.
  std::vector<double> pixels;
  /// The cameras' and then the points' numbers.
  std::vector<double> values;

  static constexpr int headerNumbers = 3;
  static constexpr int observationNumbers = 4;
  static constexpr int cameraNumbers = 9;
  static constexpr int pointNumbers = 3;
};

/// Reads the numbers. Files with one observation a line and one number a line after them, as all published ones, are
/// read by `threads` threads in pieces; others, and files with an error, from front to end. Throws ParseError at the
/// first number that is wrong, missing or too much. Memory is reserved only for counts that the text's length allows.
BalContent readBalContent(const SourceText& source, int threads);

/// Where the number of that index stands, counted from the header's first. For messages: O(size).
const char* balNumberPlace(const SourceText& source, std::size_t index);

}  // namespace quiver::detail
