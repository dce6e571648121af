#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <quiver/core/io/g2o/g2o_lines.h>
#include <quiver/core/io/g2o/g2o_reader.h>

namespace quiver::detail {

/// Gives the lines that are no elements to the elements they belong to: FIX and #quiver lines set what they say,
/// comments go to the element that follows, data lines and unknown ones to the element before. Chunks are to be applied
/// in the order of the file.
class G2oAnnotations {
 public:
  G2oAnnotations(const SourceText& source, const ReadOptions& options, Graph& graph)
      : source_(source), options_(options), graph_(graph) {}

  /// The chunk's elements are in the graph. Throws ParseError for what cannot be done.
  void apply(const G2oChunk& chunk);
  /// To be called after the last chunk.
  void finish();

 private:
  void takeElement(const G2oLine& line);
  void fix(const G2oChunk& chunk, const G2oLine& line);
  void keep(const G2oLine& line);
  void unknown(const G2oLine& line, std::string_view tag);
  void directive(const G2oLine& line);
  void setKernel(TextScanner& scanner);
  void setLevel(TextScanner& scanner);
  void setFixedDirections(TextScanner& scanner);
  Edge& edgeBefore(const char* place, const char* what);
  double number(TextScanner& scanner, const char* whatIsMissing);
  std::int64_t integer(TextScanner& scanner, std::int64_t least, std::int64_t most, const char* what);
  void expectEnd(TextScanner& scanner);
  Attachment& attachmentOf(const G2oLine& line);
  std::string textOf(const G2oLine& line) const;

  const SourceText& source_;
  const ReadOptions& options_;
  Graph& graph_;
  /// The element before, if any. Lives in a chunk.
  const G2oLine* last_ = nullptr;
  std::vector<std::string> comments_;
  /// Positions in the report's list.
  std::unordered_map<std::string, std::size_t> unknownTags_;
};

}  // namespace quiver::detail
