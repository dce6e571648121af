#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// Throws OutputError for the first path that could not be written, and UsageError if two of them are standard output
/// or the same file. Empty paths are skipped. To be asked before long work.
void checkOutputs(const std::vector<std::string>& paths);

/// Throws OutputError if the format that the name of `path` asks for cannot hold the graph. To be asked before long
/// work; an empty path is skipped.
void checkOutputFormat(const std::string& path, const Graph& graph);

/// Write whole files ("-" is standard output). Throw OutputError.
void saveText(const std::string& path, std::string_view text);
/// Indented, one key a line; numbers that are not finite become null.
void saveJson(const std::string& path, const nlohmann::ordered_json& json);
void saveGraph(const std::string& path, const Graph& graph, int threads = 0);

}  // namespace quiver::app
