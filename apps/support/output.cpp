#include <quiver/apps/support/output.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

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

}  // namespace

void checkOutputs(const std::vector<std::string>& paths) {
  std::vector<std::string> seen;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    if (std::find(seen.begin(), seen.end(), path) != seen.end())
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
