#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/info/graph_survey.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/initial_guess.h>
#include <quiver/apps/support/log_dialect.h>
#include <quiver/apps/support/output.h>
#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/types_sba/depth.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

struct Flags {
  GraphSource source;
  Dialect dialect = Dialect::g2o;
  std::string json;
  bool plan = false;
  int worst = 5;
};

Json describeSurvey(const GraphSurvey& survey) {
  Json json;
  json["parameters"] = survey.parameters;
  json["fixed"] = survey.fixed;
  json["partly_fixed"] = survey.partlyFixed;
  json["components"] = survey.components;
  json["largest_component"] = survey.largestComponent;
  json["degrees"] = Json::object();
  for (const auto& [degree, count] : survey.degrees) json["degrees"][std::to_string(degree)] = count;
  json["isolated"] = survey.isolated;
  json["without_estimate"] = survey.withoutEstimate;
  json["zero_information"] = survey.zeroInformation;
  json["parallel_edges"] = survey.parallel;
  json["kernels"] = survey.kernels;
  json["levels"] = Json::object();
  for (const auto& [level, count] : survey.levels) json["levels"][std::to_string(level)] = count;
  return json;
}

Json describeChi2(Graph& graph, int worst) {
  std::vector<EdgeChi2> edges = evaluateEdges(graph);
  double chi2 = 0.0;
  double cost = 0.0;
  for (const EdgeChi2& edge : edges) {
    chi2 += edge.chi2;
    cost += edge.cost;
  }
  std::stable_sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.chi2 > b.chi2; });
  Json json{{"chi2", chi2}, {"cost", cost}};
  json["worst_edges"] = Json::array();
  for (std::size_t i = 0; i < edges.size() && i < static_cast<std::size_t>(worst); ++i) {
    const Edge& edge = *edges[i].edge;
    json["worst_edges"].push_back(
        {{"type", graph.typeOf(edge).tag()}, {"vertices", edge.vertexIds()}, {"chi2", edges[i].chi2}});
  }
  return json;
}

Json describeGauge(Graph& graph) {
  Json json = Json::array();
  const Problem problem(graph, {.level = -1, .free = {}, .threads = 1});
  if (problem.variables() == 0) return json;
  for (const ComponentGauge& gauge : findGauges(problem)) {
    json.push_back({{"vertices", gauge.variables.size()},
                    {"free_directions", gauge.free},
                    {"tested", gauge.tested},
                    {"anchor", gauge.anchor < 0 ? Json(nullptr)
                                                : Json(problem.vertex(problem.slotOfVariable(gauge.anchor)).id())}});
  }
  return json;
}

/// What `optimize` would decide: it is asked to, and to take no step.
Json describePlan(Graph graph, int threads) {
  Options options;
  options.maxIterations = 0;
  options.threads = threads;
  const InitialGuess guess = makeInitialGuess(graph, "auto", options);
  const Summary summary = optimize(graph, options);
  const SolvePlan& plan = summary.plan;
  return {{"initial_guess", guess.name},
          {"initial_guess_reason", guess.reason},
          {"algorithm", plan.algorithm},
          {"algorithm_reason", plan.algorithmReason},
          {"linear_solver", plan.linearSolver},
          {"linear_solver_reason", plan.linearSolverReason},
          {"ordering", plan.ordering},
          {"ordering_reason", plan.orderingReason},
          {"eliminated", plan.eliminated},
          {"eliminated_types", plan.eliminatedTypes},
          {"elimination_reason", plan.eliminationReason},
          {"gauge_fixed", summary.gauge.fixed},
          {"gauge_reason", summary.gauge.reason},
          {"scalars", plan.scalars},
          {"factor_nonzeros", plan.factorNonzeros},
          {"factor_flops", plan.factorFlops},
          {"bytes", plan.bytes}};
}

std::string countsOf(const Json& counts) {
  std::string text;
  for (const auto& [tag, count] : counts.items())
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count.get<std::int64_t>(), tag);
  return text.empty() ? "none" : text;
}

/// The first few entries of a list, and how many more there are.
std::string firstOf(const Json& list) {
  constexpr std::size_t shown = 8;
  std::string text;
  for (std::size_t i = 0; i < list.size() && i < shown; ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", list[i].is_string() ? list[i].get<std::string>() : list[i].dump());
  if (list.size() > shown) text += fmt::format(" and {} more", list.size() - shown);
  return text;
}

std::string degreesOf(const Json& degrees) {
  std::int64_t vertices = 0;
  std::int64_t ends = 0;
  std::int64_t least = -1;
  std::int64_t most = 0;
  for (const auto& [text, count] : degrees.items()) {
    const std::int64_t degree = std::stoll(text);
    if (least < 0) least = degree;
    most = std::max(most, degree);
    vertices += count.get<std::int64_t>();
    ends += degree * count.get<std::int64_t>();
  }
  if (vertices == 0) return "no vertices";
  return fmt::format("{} to {}, {:.2f} on average", least, most,
                     static_cast<double>(ends) / static_cast<double>(vertices));
}

void printLine(const char* name, const std::string& text) { fmt::print("{:<12} {}\n", name, text); }

void printStructure(const Json& json) {
  const Json& input = json["input"];
  printLine("file", fmt::format("{} ({}, {} bytes)", input["file"].get<std::string>(),
                                input["format"].get<std::string>(), input["bytes"].get<std::int64_t>()));
  printLine("vertices", countsOf(input["vertices"]));
  printLine("edges", countsOf(input["edges"]));
  if (!json["parameters"].empty()) printLine("parameters", countsOf(json["parameters"]));
  printLine("fixed", fmt::format("{}, in part {}", json["fixed"].get<int>(), json["partly_fixed"].get<int>()));
  printLine("components", fmt::format("{}, the largest of {} vertices", json["components"].get<std::int64_t>(),
                                      json["largest_component"].get<std::int64_t>()));
  printLine("degrees", degreesOf(json["degrees"]));
  if (!json["kernels"].empty()) printLine("kernels", countsOf(json["kernels"]));
  if (json["levels"].size() > 1) printLine("levels", countsOf(json["levels"]));
  const auto list = [&json](const char* key, const char* name) {
    if (!json[key].empty()) printLine(name, fmt::format("{}: {}", json[key].size(), firstOf(json[key])));
  };
  list("isolated", "isolated");
  list("without_estimate", "no estimate");
  list("zero_information", "zero weight");
  if (json["parallel_edges"].get<std::int64_t>() > 0)
    printLine("parallel", fmt::format("{} edges join the same vertices as another one", json["parallel_edges"].dump()));
  printLine("information", json["information"].get<std::string>());
}

/// Nothing where no camera sees anything.
Json describeDepth(const Graph& graph) {
  const DepthSurvey survey = surveyDepth(graph);
  if (survey.observations == 0) return Json();
  Json json{{"observations", survey.observations}, {"behind_camera", survey.behind}, {"first", nullptr}};
  if (survey.first) {
    const auto ids = survey.first->vertexIds();
    json["first"] = {{"type", graph.typeOf(*survey.first).tag()},
                     {"vertices", std::vector<std::int64_t>(ids.begin(), ids.end())}};
  }
  return json;
}

void printNumbers(const Json& json) {
  if (json.contains("depth") && json["depth"]["behind_camera"].get<std::int64_t>() > 0) {
    const Json& depth = json["depth"];
    printLine("depth", fmt::format("{} of {} observations are of points behind their camera, the first {} {}",
                                   depth["behind_camera"].dump(), depth["observations"].dump(),
                                   depth["first"]["type"].get<std::string>(), depth["first"]["vertices"].dump()));
  }
  if (json["chi2"].is_null()) {
    printLine("chi2", "unknown: vertices have no estimate");
  } else {
    printLine("chi2", fmt::format("{:.10g}, cost {:.10g}", json["chi2"].get<double>(), json["cost"].get<double>()));
    for (const Json& edge : json["worst_edges"]) {
      std::string ids;
      for (const Json& id : edge["vertices"]) ids += " " + id.dump();
      printLine("", fmt::format("{:>16.6g}  {}{}", edge["chi2"].get<double>(), edge["type"].get<std::string>(), ids));
    }
  }
  for (const Json& gauge : json["gauge"]) {
    printLine("gauge",
              fmt::format("{} free directions in a component of {} unknown vertices{}", gauge["free_directions"].dump(),
                          gauge["vertices"].dump(), gauge["tested"].get<bool>() ? "" : " (not all could be tested)"));
  }
  if (!json.contains("plan")) return;
  fmt::print("plan\n");
  for (const auto& [key, value] : json["plan"].items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!text.empty()) fmt::print("  {:<22} {}\n", key, text);
  }
}

void info(const Flags& flags) {
  checkOutputs({flags.json});
  LoadedGraph loaded = loadGraph(flags.source);
  for (const std::string& note : readingNotes(flags.source, loaded.report)) fmt::print(stderr, "{}\n", note);
  Json json;
  json["quiver"] = QUIVER_VERSION;
  json["input"] = describeInput(flags.source, loaded);
  if (flags.dialect == Dialect::logarithm) loaded.graph = withLogarithmicEdges(loaded.graph);
  Graph& graph = loaded.graph;
  const GraphSurvey survey = surveyGraph(graph);
  json.update(describeSurvey(survey));
  json["information"] = loaded.report.clampedInformation == 0
                            ? "every matrix is finite, symmetric and positive semi-definite"
                            : fmt::format("{} matrices were repaired", loaded.report.clampedInformation);
  if (survey.withoutEstimate.empty()) {
    json.update(describeChi2(graph, flags.worst));
    json["gauge"] = describeGauge(graph);
  } else {
    json.update(Json{{"chi2", nullptr}, {"cost", nullptr}, {"worst_edges", Json::array()}, {"gauge", Json::array()}});
  }
  if (Json depth = describeDepth(graph); !depth.is_null()) json["depth"] = std::move(depth);
  if (flags.plan) json["plan"] = describePlan(graph, flags.source.threads);
  if (!flags.json.empty()) saveJson(flags.json, json);
  if (flags.json == "-") return;
  printStructure(json);
  printNumbers(json);
}

}  // namespace

void addInfoCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("info", "Tell what is in a graph: counts, components, chi2, trouble");
  auto flags = std::make_shared<Flags>();
  addSourceOptions(*command, flags->source);
  addDialectOption(*command, flags->dialect);
  command->add_flag("--plan", flags->plan, "Tell what optimize would decide, and why");
  command->add_option("--worst", flags->worst, "How many of the edges with the largest chi2 to show")
      ->type_name("N")
      ->check(CLI::Range(0, 1000000).description(""))
      ->capture_default_str();
  command->add_option("--json", flags->json, "Write all of it as JSON here (- is standard output)")->type_name("FILE");
  command->footer("Examples:\n  quiver info city.g2o\n  quiver info city.g2o --plan --worst 20 --json city.json");
  command->callback([flags] { info(*flags); });
}

}  // namespace quiver::app
