#pragma once

#include <string_view>
#include <unordered_set>

#include <quiver/core/io/g2o/g2o_lines.h>
#include <quiver/core/io/text/number_writer.h>
#include <quiver/core/registry/registry.h>
#include <quiver/core/util/function_ref.h>

namespace quiver::detail {

/// Makes rows of a table of the lines of a .g2o file. Before the first row of a type stands a row with the names of its
/// fields, which begins with "tag". Comments stay as they are, data lines are one cell.
class CsvWriter {
 public:
  /// `sink` outlives this.
  CsvWriter(const Registry& registry, FunctionRef<void(std::string_view)> sink) : tags_(registry), sink_(sink) {}

  /// Takes whole lines.
  void write(std::string_view lines);

 private:
  void writeLine(std::string_view line);
  void writeHeading(const TagEntry& entry);
  void writeText(std::string_view line);
  void writeCell(std::string_view cell);

  TagTable tags_;
  FunctionRef<void(std::string_view)> sink_;
  NumberWriter out_;
  std::unordered_set<const TagEntry*> named_;
  /// Whether a row has been written that tells that this is a table.
  bool told_ = false;
};

}  // namespace quiver::detail
