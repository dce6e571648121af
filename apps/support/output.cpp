#include <quiver/apps/support/output.h>

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <quiver/apps/support/outcome.h>
#include <quiver/core/io/files/output_file.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/types_slam3d/addons/euler_conversion.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver::app {
namespace {

bool holdsQuaternions(const Graph& graph) {
  const VertexType* type = graph.registry()->findVertexTypeByName(typeName<VertexSE3>());
  bool found = false;
  graph.forEachVertex([&](const Vertex& vertex) { found = found || &graph.typeOf(vertex) == type; });
  return found;
}

/// Whether two paths lead to one file, which need not exist. Devices, as /dev/null, take what any number write.
bool sameFile(const std::string& a, const std::string& b) {
  if (a == "-" || b == "-") return a == b;
  std::error_code error;
  if (std::filesystem::is_character_file(a, error)) return false;
  if (a == b || std::filesystem::equivalent(a, b, error)) return true;
  const auto resolve = [&error](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  };
  const std::filesystem::path one = resolve(a);
  return !one.empty() && one == resolve(b);
}

}  // namespace

void checkOutputs(const std::vector<std::string>& paths) {
  std::vector<std::string> seen;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    if (std::any_of(seen.begin(), seen.end(), [&path](const std::string& other) { return sameFile(other, path); }))
      throw UsageError(fmt::format("two outputs go to {}", path == "-" ? "standard output" : path));
    seen.push_back(path);
  }
  for (const std::string& path : seen) {
    try {
      checkWritable(path);
    } catch (const FileError& error) {
      throw OutputError(error.what());
    }
  }
}

void checkInputsSpared(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (const std::string& output : outputs) {
    for (const std::string& input : inputs) {
      if (output.empty() || input.empty() || output == "-" || !sameFile(output, input)) continue;
      throw UsageError(fmt::format("{} would be replaced: it is read, and is to be written as something else", output));
    }
  }
}

void checkOutputFormat(const std::string& path, const Graph& graph, std::optional<GraphFormat> format) {
  if (path.empty()) return;
  const GraphFormat chosen = format.value_or(formatOfPath(path));
  try {
    if (holdsQuaternions(graph) && chosen == GraphFormat::toro) {
      checkFormat(chosen, withEulerAngles(graph));
    } else {
      checkFormat(chosen, graph);
    }
  } catch (const GraphError& error) {
    throw OutputError(fmt::format("{}: {}", path, error.what()));
  }
}

void checkStreamedFormat(const std::string& path, std::initializer_list<GraphFormat> formats) {
  if (std::find(formats.begin(), formats.end(), formatOfPath(path)) == formats.end())
    throw UsageError(fmt::format("{}: this is written as it is made, in no format but .g2o{}; convert it then", path,
                                 formats.size() > 1 ? " and .bal" : ""));
}

void saveText(const std::string& path, std::string_view text) {
  try {
    OutputFile file(path);
    file.write(text);
    file.commit();
  } catch (const FileError& error) {
    throw OutputError(error.what());
  }
}

void saveJson(const std::string& path, const nlohmann::ordered_json& json) {
  saveText(path, json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void saveGraph(const std::string& path, const Graph& graph, int threads, std::optional<GraphFormat> format) {
  WriteOptions options;
  options.threads = threads;
  options.format = format.value_or(formatOfPath(path));
  try {
    if (options.format == GraphFormat::toro && holdsQuaternions(graph)) {
      writeGraph(path, withEulerAngles(graph), options);
    } else {
      writeGraph(path, graph, options);
    }
  } catch (const FileError& error) {
    throw OutputError(error.what());
  }
}

}  // namespace quiver::app
