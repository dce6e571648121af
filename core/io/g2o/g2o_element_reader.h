#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <quiver/core/io/g2o/g2o_field_reader.h>
#include <quiver/core/io/g2o/g2o_lines.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/information_check.h>

namespace quiver::detail {

/// Information matrices of a piece of a file that are none.
struct InformationFaults {
  std::int64_t clamped = 0;
  std::int64_t refused = 0;
  /// The first of those that were refused, and its eigenvalues.
  const char* firstRefused = nullptr;
  EigenvalueRange firstRange;
};

/// Reads the fields of lines into their elements. Not thread safe: threads have their own.
class G2oElementReader {
 public:
  G2oElementReader(const SourceText& source, const TagTable& tags, const ReadOptions& options)
      : source_(source), tags_(tags), options_(options) {}

  /// `element` is the line's Vertex, Edge or Parameter. Throws ParseError where the fields are wrong; information
  /// matrices that are none are mended or counted, as the options say.
  void read(const G2oLine& line, void* element);
  const InformationFaults& faults() const { return faults_; }

 private:
  void readEdge(const G2oLine& line, Edge& edge, G2oFieldReader& reader);
  void readInformation(const EdgeType& type, const G2oLine& line, Edge& edge, G2oFieldReader& reader);
  /// Sets triangle_ as the edge's information; returns whether it is one as it stands.
  bool setInformation(const EdgeType& type, Edge& edge, const char* place);
  void refuseHopeless(const G2oLine& line) const;

  const SourceText& source_;
  const TagTable& tags_;
  const ReadOptions& options_;
  InformationCheck check_;
  InformationFaults faults_;
  /// The information matrix of the edge before.
  std::vector<double> triangle_;
  /// What it was read from, and by lines of which tag, if its text tells all: files repeat them.
  std::string_view triangleText_;
  const TagEntry* triangleEntry_ = nullptr;
};

}  // namespace quiver::detail
