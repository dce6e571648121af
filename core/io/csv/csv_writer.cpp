#include <quiver/core/io/csv/csv_writer.h>

#include <string>

#include <fmt/format.h>

namespace quiver::detail {

void CsvWriter::write(std::string_view lines) {
  out_.clear();
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    writeLine(lines.substr(0, end));
    lines.remove_prefix(end == std::string_view::npos ? lines.size() : end + 1);
  }
  sink_(out_.view());
}

void CsvWriter::writeLine(std::string_view line) {
  if (line.empty() || line.front() == '#') {
    out_.text(line);
    return out_.character('\n');
  }
  const TagEntry* entry = tags_.find(line.substr(0, line.find(' ')));
  if (!entry || entry->kind == LineKind::data) return writeText(line);
  if (entry->kind != LineKind::fix && named_.insert(entry).second) writeHeading(*entry);
  told_ = true;
  for (const char* separator = "";; separator = ",") {
    const std::size_t end = line.find(' ');
    out_.text(separator);
    writeCell(line.substr(0, end));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end + 1);
  }
  out_.character('\n');
}

void CsvWriter::writeHeading(const TagEntry& entry) {
  out_.text("tag");
  if (entry.kind == LineKind::edge) {
    for (int i = 0; i < entry.arity; ++i) out_.text(fmt::format(",id{}", i + 1));
    if (entry.variableArity) out_.text(",…,||");
    for (int i = 0; i < entry.parameters; ++i) out_.text(fmt::format(",parameter{}", i + 1));
  } else {
    out_.text(",id");
  }
  const ElementType& type = tags_.elementType(entry);
  for (const Field& field : type.fields()) out_.text(fmt::format(",{}", field.name));
  if (entry.kind == LineKind::edge) {
    const EdgeType& edge = static_cast<const EdgeType&>(type);
    const int n = edge.hasInformationField() ? edge.errorDimension() : 0;
    for (int row = 1; row <= n; ++row) {
      for (int column = row; column <= n; ++column) out_.text(fmt::format(",I{}{}", row, column));
    }
    if (n == Dynamic) out_.text(",information");
    for (const Field& field : type.tailFields()) out_.text(fmt::format(",{}", field.name));
  }
  out_.character('\n');
}

void CsvWriter::writeText(std::string_view line) {
  if (!told_) out_.text("tag,text\n");
  told_ = true;
  writeCell(line);
  out_.character('\n');
}

/// In quotes if it holds a comma, a quote, or what a heading begins with.
void CsvWriter::writeCell(std::string_view cell) {
  if (cell.find_first_of(",\"") == std::string_view::npos && cell != "tag") return out_.text(cell);
  out_.character('"');
  for (const char c : cell) {
    if (c == '"') out_.character('"');
    out_.character(c);
  }
  out_.character('"');
}

}  // namespace quiver::detail
