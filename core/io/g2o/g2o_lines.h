#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <quiver/core/graph/bulk_adder.h>
#include <quiver/core/io/text/source_text.h>
#include <quiver/core/io/text/text_scanner.h>
#include <quiver/core/registry/registry.h>

namespace quiver::detail {

enum class LineKind : std::uint8_t {
  parameter,
  vertex,
  /// A vertex without an estimate: "#quiver vertex TAG id".
  blankVertex,
  edge,
  fix,
  data,
  comment,
  directive,
  unknown,
};

/// Planar TORO files hold g2o's types by other names and with other numbers; the spatial ones are g2o's VERTEX3, EDGE3.
enum class LineDialect : std::uint8_t {
  g2o,
  /// VERTEX2 and EDGE2: the information matrix is I11 I12 I22 I33 I13 I23.
  toro,
  /// BR: bearing, range and their standard deviations, where the type takes the point in the pose's frame and its
  /// information.
  bearingRange,
};

/// What a tag stands for.
struct TagEntry {
  LineKind kind = LineKind::unknown;
  /// Index in the registry's list of vertex, edge or parameter types.
  int type = -1;
  /// How the line differs from what the type itself would read.
  LineDialect dialect = LineDialect::g2o;
  /// Whether the tag is one of TORO's.
  bool toro = false;
  /// Edges only: number of vertices (the least one), whether there may be more, and of parameters.
  int arity = 0;
  bool variableArity = false;
  int parameters = 0;
  /// Edges only: whether the line carries the information matrix.
  bool informationInLine = true;
};

/// Every tag a file may use, with what reading its lines needs. Immutable after construction, so threads share it.
class TagTable {
 public:
  explicit TagTable(const Registry& registry);
  /// nullptr if unknown.
  const TagEntry* find(std::string_view tag) const;
  const Registry& registry() const { return registry_; }
  /// The descriptor of a parameter, vertex or edge entry.
  const ElementType& elementType(const TagEntry& entry) const;

 private:
  /// Unless there is an entry for the tag.
  void add(std::string_view tag, const TagEntry& entry);
  void addToroTag(std::string_view tag, std::string_view g2oTag, LineDialect dialect);

  const Registry& registry_;
  std::vector<std::pair<std::string_view, TagEntry>> entries_;  // by tag
};

/// One line that is not blank.
struct G2oLine {
  /// Its first token.
  const char* begin = nullptr;
  /// The first token after the ids; nullptr where the kind has no fields.
  const char* fields = nullptr;
  /// The tag's entry; nullptr where the tag is none of the table.
  const TagEntry* entry = nullptr;
  /// The ids of vertices, then of parameters: positions in G2oChunk::ids.
  std::uint32_t firstId = 0;
  std::uint32_t idCount = 0;
  LineKind kind = LineKind::unknown;
  /// The Vertex, Edge or Parameter, once the graph has it.
  void* element = nullptr;
};

/// A piece of a text that ends at a line's end, taken apart into lines, tags and ids.
struct G2oChunk {
  std::string_view text;
  std::vector<G2oLine> lines;
  std::vector<std::int64_t> ids;
  /// Of the lines that are vertices and edges.
  ElementCounts counts;

  std::span<const std::int64_t> idsOf(const G2oLine& line) const { return {ids.data() + line.firstId, line.idCount}; }
};

/// Takes one chunk apart. Thread safe for different chunks.
class G2oIndexer {
 public:
  G2oIndexer(const SourceText& source, const TagTable& tags, bool refuseUnknown, G2oChunk& chunk)
      : source_(source), tags_(tags), refuseUnknown_(refuseUnknown), chunk_(chunk), scanner_(chunk.text) {}

  /// Fills the chunk. Throws ParseError at the first line whose tag or ids are wrong; the lines before
  /// it are kept.
  void run();

 private:
  void readLine();
  std::string_view readTag();
  void readHash(std::string_view word, G2oLine& line);
  void count(const G2oLine& line);
  const TagEntry* lookUp(std::string_view tag);
  void readEdgeIds(const TagEntry& entry, std::string_view tag);
  void readFixIds();
  void refuseBinary(const char* begin);
  /// Appends the next token, an id ≥ 0, to chunk.ids. `missing` describes what is missing if the line ends.
  template <typename Describe>
  void readId(const char* what, Describe missing);
  [[noreturn]] void refuseTag(std::string_view tag) const;

  const SourceText& source_;
  const TagTable& tags_;
  bool refuseUnknown_;
  G2oChunk& chunk_;
  TextScanner scanner_;
  std::string_view lastTag_;
  const TagEntry* lastEntry_ = nullptr;
};

/// Cuts a text after line ends into pieces of about the given size.
std::vector<G2oChunk> cutIntoChunks(std::string_view text, std::size_t size);

}  // namespace quiver::detail
