#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <quiver/core/graph/graph.h>
#include <quiver/core/io/files/graph_format.h>

namespace quiver::app {

/// Throws OutputError for the first path that could not be written, and UsageError if two of them are standard output
/// or the same file, however it is spelled. Empty paths are skipped. To be asked before long work.
void checkOutputs(const std::vector<std::string>& paths);

/// Throws UsageError if an output would replace an input. For outputs of another kind than the input: a picture or a
/// report in place of a graph is a slip of the keyboard. Empty paths and "-" are skipped.
void checkInputsSpared(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// Throws OutputError if the format, or the one that the name of `path` asks for, cannot hold the graph. To be asked
/// before long work; an empty path is skipped.
void checkOutputFormat(const std::string& path, const Graph& graph, std::optional<GraphFormat> format = {});

/// Throws UsageError if the name of `path` asks for another format than those. For what is written as it is made.
void checkStreamedFormat(const std::string& path, std::initializer_list<GraphFormat> formats);

/// Write whole files ("-" is standard output). Throw OutputError.
void saveText(const std::string& path, std::string_view text);
/// Indented, one key a line; numbers that are not finite become null.
void saveJson(const std::string& path, const nlohmann::ordered_json& json);
/// Poses in space become TORO's where the format is that.
void saveGraph(const std::string& path, const Graph& graph, int threads = 0, std::optional<GraphFormat> format = {});

}  // namespace quiver::app
