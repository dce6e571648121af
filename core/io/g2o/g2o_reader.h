#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// What becomes of lines whose tag the registry does not know: an error, left out, or kept as text with the element
/// before them (numbers, and words with a comma or a quote, are no tags that can be kept).
enum class UnknownTags { error, skip, keep };

/// What becomes of information matrices with an eigenvalue below −1e-6 of the largest: an error, or negative
/// eigenvalues to zero.
enum class InformationPolicy { check, clamp };

/// What reading found out beside the graph.
struct ReadReport {
  /// "g2o", "toro", "csv" or "bal". A file is TORO's if all its tags are.
  std::string format;
  /// Size of the file before and after inflating.
  std::int64_t storedBytes = 0;
  std::int64_t textBytes = 0;
  /// Information matrices that InformationPolicy::clamp repaired.
  std::int64_t clampedInformation = 0;
  /// Tags of lines that were skipped or kept as text, with their numbers, in order of appearance.
  std::vector<std::pair<std::string, std::int64_t>> unknownTags;
};

struct ReadOptions {
  UnknownTags unknown = UnknownTags::error;
  InformationPolicy information = InformationPolicy::check;
  /// At most so many threads; 0: as many as the machine offers. The graph is the same for any number.
  int threads = 0;
  /// Filled if given.
  ReadReport* report = nullptr;
};

/// Reads a graph from a .g2o or TORO file, a table (CSV) or a file of "bundle adjustment in the large" (BAL), told
/// apart by their text; plain, gzip or bzip2; "-" is standard input.
///
/// Lines may come in any order: edges before vertices, FIX and parameters anywhere. A file without vertex lines gets
/// vertices without an estimate, of the types its edges join. Comments stay with the element that follows them, data
/// lines with the one before;
/// "#quiver" lines carry what the format cannot (see writeGraph). Estimates are kept to the last bit. TORO's VERTEX2
/// and EDGE2 become VERTEX_SE2 and EDGE_SE2, its bearings and ranges (BR) points seen from a pose, EDGE_SE2_XY;
/// landmarks without a line of their own then have no estimate. Of BAL, cameras become VERTEX_CAMERA:BAL with the ids
/// 0, 1, …, points VERTEX_TRACKXYZ with the ids after them, and observations EDGE_PROJECT_BAL with information I.
///
/// Throws FileError if the file cannot be read, ParseError at the first line that is wrong. Information matrices that
/// are none are counted to the end of the file. O(size of the file).
Graph readGraph(const std::string& path, std::shared_ptr<const Registry> registry, const ReadOptions& options = {});

/// readGraph() for a text in memory; `name` is what messages call it.
Graph readGraphText(std::string_view text, const std::string& name, std::shared_ptr<const Registry> registry,
                    const ReadOptions& options = {});

}  // namespace quiver
