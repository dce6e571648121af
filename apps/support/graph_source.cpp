#include <quiver/apps/support/graph_source.h>

#include <map>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/support/cholmod_on_demand.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/core/util/stopwatch.h>
#include <quiver/plugins/builtin.h>
#include <quiver/plugins/plugin_loader.h>

namespace quiver::app {

void addPluginOption(CLI::App& command, std::vector<std::string>& plugins) {
  command.add_option("--plugin", plugins, "Shared library that brings types or solvers; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(inputPath());
}

void addThreadsOption(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads at most; 0: as the machine has. Results do not depend on it")
      ->type_name("N")
      ->transform(wholeNumber(0, 4096));
}

void addSourceOptions(CLI::App& command, GraphSource& source) {
  command
      .add_option("IN", source.path,
                  "Graph to read (.g2o, TORO, CSV, BAL, told by content; .gz and .bz2 too; - is standard input)")
      ->required()
      ->type_name("");
  addReadingOptions(command, source);
}

void addReadingOptions(CLI::App& command, GraphSource& source) {
  addPluginOption(command, source.plugins);
  static const std::map<std::string, UnknownTags> unknown{
      {"error", UnknownTags::error}, {"skip", UnknownTags::skip}, {"keep", UnknownTags::keep}};
  command
      .add_option("--unknown", source.unknown,
                  "Lines of unknown tag: refuse the file, leave them out, or keep them as text")
      ->type_name("error|skip|keep")
      ->transform(wordOf(unknown))
      ->default_str("error");
  static const std::map<std::string, InformationPolicy> information{{"check", InformationPolicy::check},
                                                                    {"clamp", InformationPolicy::clamp}};
  command
      .add_option("--information", source.information,
                  "Information matrices with negative eigenvalues: refuse the file, or set those to zero")
      ->type_name("check|clamp")
      ->transform(wordOf(information))
      ->default_str("check");
  addThreadsOption(command, source.threads);
}

CLI::Option* addDialectOption(CLI::App& command, Dialect& dialect) {
  static const std::map<std::string, Dialect> dialects{{"g2o", Dialect::g2o}, {"log", Dialect::logarithm}};
  return command
      .add_option("--dialect", dialect,
                  "Residual of EDGE_SE3:QUAT: g2o's (translation, quaternion vector), or the logarithm of the pose")
      ->type_name("g2o|log")
      ->transform(wordOf(dialects))
      ->default_str("g2o");
}

std::shared_ptr<Registry> makeRegistry(const std::vector<std::string>& plugins) {
  auto registry = builtinRegistry();
  addCholmodOnDemand(*registry);
  for (const std::string& plugin : plugins) loadPlugin(*registry, plugin);
  return registry;
}

ReadOptions readOptions(const GraphSource& source, ReadReport& report) {
  ReadOptions options;
  options.unknown = source.unknown;
  options.information = source.information;
  options.threads = source.threads;
  options.report = &report;
  return options;
}

LoadedGraph loadGraph(const GraphSource& source) {
  const auto registry = makeRegistry(source.plugins);
  const Stopwatch watch;
  ReadReport report;
  Graph graph = readGraph(source.path, registry, readOptions(source, report));
  return {std::move(graph), std::move(report), watch.seconds()};
}

std::string displayName(const std::string& path) { return path == "-" ? "<stdin>" : path; }

nlohmann::ordered_json describeInput(const GraphSource& source, const LoadedGraph& loaded) {
  std::map<std::string, std::int64_t> vertices;
  std::map<std::string, std::int64_t> edges;
  const Graph& graph = loaded.graph;
  graph.forEachVertex([&](const Vertex& vertex) { ++vertices[graph.typeOf(vertex).tag()]; });
  graph.forEachEdge([&](const Edge& edge) { ++edges[graph.typeOf(edge).tag()]; });
  nlohmann::ordered_json json;
  json["file"] = displayName(source.path);
  json["format"] = loaded.report.format;
  json["bytes"] = loaded.report.storedBytes;
  json["vertices"] = nlohmann::ordered_json::object();
  for (const auto& [tag, count] : vertices) json["vertices"][tag] = count;
  json["edges"] = nlohmann::ordered_json::object();
  for (const auto& [tag, count] : edges) json["edges"][tag] = count;
  return json;
}

std::vector<std::string> readingNotes(const GraphSource& source, const ReadReport& report) {
  std::vector<std::string> notes;
  for (const auto& [tag, count] : report.unknownTags) {
    notes.push_back(fmt::format("{}: {} line{} of unknown tag '{}' {}", displayName(source.path), count,
                                count == 1 ? "" : "s", tag,
                                source.unknown == UnknownTags::keep ? "kept as text" : "skipped"));
  }
  if (report.clampedInformation > 0) {
    notes.push_back(fmt::format("{}: {} information {} had negative eigenvalues, set to zero", displayName(source.path),
                                report.clampedInformation, report.clampedInformation == 1 ? "matrix" : "matrices"));
  }
  return notes;
}

}  // namespace quiver::app
