#pragma once

#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <quiver/core/graph/bulk_adder.h>
#include <quiver/core/io/g2o/g2o_element_reader.h>
#include <quiver/core/io/g2o/g2o_lines.h>
#include <quiver/core/io/g2o/g2o_reader.h>

namespace quiver::detail {

/// Loads one .g2o text: lines are taken apart into tags and ids (parallel), vertices and parameters get their ids (in
/// the order of the file), elements are made and their fields read in place (parallel), and text and marks go to the
/// elements they belong to.
class G2oLoader {
 public:
  G2oLoader(const SourceText& source, std::shared_ptr<const Registry> registry, const ReadOptions& options);
  /// Throws the first error of the first of those steps that finds one; wrong fields above an error of the first two
  /// come before it.
  Graph load();

 private:
  /// What making and reading the elements of one chunk found. The first trouble ends it.
  struct ChunkResult {
    InformationFaults faults;
    /// An edge that the graph does not take, and why.
    const G2oLine* refusedEdge = nullptr;
    std::string refusal;
    std::optional<ParseError> error;
    std::exception_ptr failure;
  };

  void index();
  bool isToro() const;
  void nameVertices(BulkAdder& adder);
  void addVerticesOfEdges(bool allEdges);
  void addElements();
  /// Thread safe for different chunks.
  void fillChunk(std::size_t chunk, BulkAdder& adder, ChunkResult& result);
  /// Throws the first error of making and reading elements, in the order of the file, else that of the first
  /// information matrix that is refused; counts what was clamped.
  void report(const std::vector<ChunkResult>& results) const;
  void refuseInformation(const std::vector<ChunkResult>& results) const;
  /// Throws the first error in the fields of the lines before `line`, which counts from 1, if there is one.
  void checkFieldsBefore(std::int64_t line) const;

  ParseError duplicate(const G2oLine& line, std::int64_t id, const char* what) const;
  ParseError edgeError(const G2oLine& line, std::span<const std::int64_t> ids, const std::string& message) const;

  const SourceText& source_;
  const ReadOptions& options_;
  int threads_;
  TagTable tags_;
  Graph graph_;
  std::vector<G2oChunk> chunks_;
};

}  // namespace quiver::detail
