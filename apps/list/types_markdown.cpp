#include <quiver/apps/list/types_markdown.h>

#include <nlohmann/json.hpp>

#include <fmt/format.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

/// Text that a table's cell takes as it is.
std::string cell(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '_' || c == '<') safe += '\\';
    safe += c == '\n' ? ' ' : c;
  }
  return safe;
}

std::string fieldsOf(const Json& fields) {
  std::string text;
  for (const Json& field : fields) {
    const std::string unit = field["unit"].get<std::string>();
    const std::string name = field["name"].get<std::string>();
    text += (text.empty() ? "" : ", ") + cell(unit.empty() ? name : fmt::format("{} [{}]", name, unit));
  }
  return text;
}

std::string tagsOf(const Json& tags) {
  std::string text;
  for (const Json& tag : tags) text += fmt::format("{}`{}`", text.empty() ? "" : ", ", tag.get<std::string>());
  return text;
}

std::string vertexRow(const Json& type) {
  std::string tangent;
  if (type.contains("tangent")) {
    for (const Json& name : type["tangent"]) tangent += (tangent.empty() ? "" : ", ") + cell(name.get<std::string>());
  }
  return fmt::format("| `{}` | {} | {} | {} |\n", type["tag"].get<std::string>(), fieldsOf(type["fields"]), tangent,
                     cell(type["documentation"].get<std::string>()));
}

std::string edgeRow(const Json& type) {
  std::string joins = tagsOf(type["vertices"]);
  if (type["any_number_of_the_last"].get<bool>()) joins += " …";
  std::string fields;
  if (!type["parameters"].empty()) fields = fmt::format("ids of {}, ", tagsOf(type["parameters"]));
  fields += fieldsOf(type["fields"]);
  if (type["information"].get<bool>()) {
    const Json& dimension = type["dimension"];
    fields += dimension.is_number() ? fmt::format(", information ({0}×{0})", dimension.get<int>())
                                    : std::string(", information");
  }
  if (type.contains("tail_fields")) fields += "; then " + fieldsOf(type["tail_fields"]);
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", type["tag"].get<std::string>(), joins, fields,
                     type["jacobians"].get<std::string>(), cell(type["documentation"].get<std::string>()));
}

}  // namespace

std::string typesAsMarkdown(const Json& registry) {
  std::string text =
      "# Types\n\nEvery tag that files may hold, as `quiver list --markdown` prints it; a test keeps this page up to "
      "date. The grammar around the fields is in [file-format.md](file-format.md).\n\n"
      "## Vertices\n\n| tag | fields | tangent | |\n|---|---|---|---|\n";
  for (const Json& type : registry["vertices"]) text += vertexRow(type);
  text += "\n## Edges\n\n| tag | joins | fields after the ids | Jacobians | |\n|---|---|---|---|---|\n";
  for (const Json& type : registry["edges"]) text += edgeRow(type);
  text += "\n## Parameters\n\n| tag | fields | |\n|---|---|---|\n";
  for (const Json& type : registry["parameters"])
    text += fmt::format("| `{}` | {} | {} |\n", type["tag"].get<std::string>(), fieldsOf(type["fields"]),
                        cell(type["documentation"].get<std::string>()));
  text += "\n## Other tags\n\n| tag | |\n|---|---|\n";
  for (const auto& [alias, tag] : registry["aliases"].items())
    text += fmt::format("| `{}` | read as `{}` |\n", alias, tag.get<std::string>());
  for (const Json& entry : registry["data"])
    text += fmt::format("| `{}` | data line: {} |\n", entry["name"].get<std::string>(),
                        cell(entry["documentation"].get<std::string>()));
  return text;
}

}  // namespace quiver::app
