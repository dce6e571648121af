#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <quiver/core/io/g2o/g2o_field_reader.h>
#include <quiver/core/io/g2o/g2o_lines.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/information_check.h>

namespace quiver::detail {

/// Loads one .g2o text, in four passes: lines are taken apart into tags and ids (parallel), elements are added to the
/// graph (in the order of the file) while the fields of those that are there are read in place (parallel), and text and
/// marks go to the elements they belong to.
class G2oLoader {
 public:
  G2oLoader(const SourceText& source, std::shared_ptr<const Registry> registry, const ReadOptions& options);
  Graph load();

 private:
  /// What reading the fields of one chunk found.
  struct FieldPass {
    InformationCheck check;
    std::vector<double> triangle;
    std::int64_t clamped = 0;
    std::int64_t refused = 0;
    const char* firstRefused = nullptr;
    EigenvalueRange firstRange;
    std::optional<ParseError> error;
  };

  void index();
  bool isToro() const;
  void addVertices();
  void addVerticesOfEdges(bool allEdges);
  void addEdgesAndReadFields();
  void addEdges(G2oChunk& chunk);
  void readFields(std::size_t chunk, FieldPass& pass) const;
  /// Throws the first error of the passes; counts what was clamped.
  void report(const std::vector<FieldPass>& passes) const;
  void readElement(const G2oLine& line, void* element, FieldPass& pass) const;
  void readInformation(const EdgeType& type, Edge& edge, bool toro, G2oFieldReader& reader, FieldPass& pass) const;
  /// Sets pass.triangle as the edge's information, if it is one; otherwise mends it or counts it, as the options say.
  void checkInformation(const EdgeType& type, Edge& edge, const char* place, FieldPass& pass) const;
  void refuseHopeless(const G2oLine& line) const;
  void refuseInformation(const std::vector<FieldPass>& passes) const;
  /// Throws the first error in the fields of the lines before `line`, which counts from 1, if there is one.
  void checkFieldsBefore(std::int64_t line) const;

  ParseError duplicate(const G2oLine& line, std::int64_t id, const char* what) const;
  ParseError edgeError(const G2oLine& line, std::span<const std::int64_t> ids, const std::string& message) const;
  std::span<const std::int64_t> idsOf(const G2oChunk& chunk, const G2oLine& line) const {
    return {chunk.ids.data() + line.firstId, line.idCount};
  }

  const SourceText& source_;
  const ReadOptions& options_;
  TagTable tags_;
  int threads_;
  Graph graph_;
  std::vector<G2oChunk> chunks_;
};

}  // namespace quiver::detail
