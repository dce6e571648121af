#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <quiver/core/graph/graph.h>
#include <quiver/core/io/g2o/g2o_reader.h>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace quiver::app {

/// Which residual EDGE_SE3:QUAT measurements are given: g2o's quaternion vector or the lectures' logarithm.
enum class Dialect { g2o, logarithm };

/// Where a graph comes from and how it is read, as the command line says.
struct GraphSource {
  std::string path;
  std::vector<std::string> plugins;
  UnknownTags unknown = UnknownTags::error;
  InformationPolicy information = InformationPolicy::check;
  int threads = 0;
};

struct LoadedGraph {
  Graph graph;
  ReadReport report;
  double seconds = 0.0;
};

/// The flags --plugin, --unknown, --information and --threads, and the positional IN.
void addSourceOptions(CLI::App& command, GraphSource& source);
/// The same without IN, for commands that read more than one file.
void addReadingOptions(CLI::App& command, GraphSource& source);
void addPluginOption(CLI::App& command, std::vector<std::string>& plugins);
void addThreadsOption(CLI::App& command, int& threads);
CLI::Option* addDialectOption(CLI::App& command, Dialect& dialect);

/// Everything this program brings, CHOLMOD included where it was built, and the plugins. Throws PluginError.
std::shared_ptr<Registry> makeRegistry(const std::vector<std::string>& plugins);

/// Reads the graph. Throws FileError, ParseError, GraphError or PluginError.
LoadedGraph loadGraph(const GraphSource& source);
/// How the source says it is read; what happens goes to `report`.
ReadOptions readOptions(const GraphSource& source, ReadReport& report);

/// {"file", "format", "bytes", "vertices": {TAG: n}, "edges": {TAG: n}}
nlohmann::ordered_json describeInput(const GraphSource& source, const LoadedGraph& loaded);

/// Sentences about lines that were skipped and matrices that were repaired while reading, each worth telling.
std::vector<std::string> readingNotes(const GraphSource& source, const ReadReport& report);

/// The path as messages show it: "<stdin>" for "-".
std::string displayName(const std::string& path);

}  // namespace quiver::app
