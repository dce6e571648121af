#include <quiver/apps/support/output.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <quiver/apps/support/outcome.h>
#include <quiver/core/io/files/output_file.h>
#include <quiver/core/io/g2o/g2o_writer.h>

namespace quiver::app {

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

void checkOutputFormat(const std::string& path, const Graph& graph) {
  if (path.empty()) return;
  try {
    checkFormat(path, graph);
  } catch (const GraphError& error) {
    throw OutputError(fmt::format("{}: {}", path, error.what()));
  }
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

void saveGraph(const std::string& path, const Graph& graph, int threads) {
  try {
    WriteOptions options;
    options.threads = threads;
    writeGraph(path, graph, options);
  } catch (const FileError& error) {
    throw OutputError(error.what());
  }
}

}  // namespace quiver::app
