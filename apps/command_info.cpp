#include <algorithm>
#include <bit>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/info/bridges.h>
#include <quiver/apps/info/graph_survey.h>
#include <quiver/apps/info/info_text.h>
#include <quiver/apps/info/loose_vertices.h>
#include <quiver/apps/info/residual_survey.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/initial_guess.h>
#include <quiver/apps/support/log_dialect.h>
#include <quiver/apps/support/long_work.h>
#include <quiver/apps/support/named_errors.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/memory_estimate.h>
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

Json describeEdge(const Graph& graph, const Edge& edge) {
  return {{"type", graph.typeOf(edge).tag()}, {"vertices", edge.vertexIds()}};
}

Json describeConnections(const Graph& graph) {
  const Connections connections = findBridges(graph);
  Json json{{"independent_cycles", connections.independentCycles}, {"bridges", Json::array()}};
  for (const Bridge& bridge : connections.bridges) {
    json["bridges"].push_back(describeEdge(graph, *bridge.edge));
    json["bridges"].back()["cut_off"] = bridge.cutOff;
  }
  return json;
}

Json describeProbabilities(const Graph& graph, const std::vector<EdgeProbability>& edges) {
  Json json = Json::array();
  for (const EdgeProbability& edge : edges) {
    json.push_back(describeEdge(graph, *edge.edge));
    json.back().update({{"chi2", edge.chi2}, {"dimension", edge.dimension}, {"p_value", edge.pValue}});
  }
  return json;
}

Json describeResiduals(Graph& graph, std::int64_t determined, int worst) {
  const ResidualSurvey survey = surveyResiduals(graph, determined, worst);
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json json{{"chi2", number(survey.chi2)}, {"cost", number(survey.cost)}};
  json["undefined"] = Json::array();
  for (const Edge* edge : survey.undefined) json["undefined"].push_back(describeEdge(graph, *edge));
  json["worst_edges"] = describeProbabilities(graph, survey.worst);
  json["redundancy"] = {{"measured", survey.measured},
                        {"determined", survey.determined},
                        {"degrees_of_freedom", survey.degreesOfFreedom},
                        {"p_value", number(survey.pValue)}};
  json["gates"] = Json::array();
  for (const Gate& gate : survey.gates)
    json["gates"].push_back({{"probability", gate.probability}, {"beyond", gate.beyond}, {"expected", gate.expected}});
  json["suspects_judged"] = survey.judged;
  json["suspects"] = describeProbabilities(graph, survey.suspects);
  return json;
}

Json describeFreedom(const Graph& graph, const Problem& problem) {
  Json json{{"gauge", Json::array()}, {"unconstrained", Json::array()}};
  if (problem.variables() == 0) return json;
  for (const ComponentGauge& gauge : findGauges(problem)) {
    json["gauge"].push_back(
        {{"vertices", gauge.variables.size()},
         {"free_directions", gauge.free},
         {"tested", gauge.tested},
         {"anchor",
          gauge.anchor < 0 ? Json(nullptr) : Json(problem.vertex(problem.slotOfVariable(gauge.anchor)).id())}});
  }
  for (const LooseVertex& loose : findLooseVertices(problem)) {
    json["unconstrained"].push_back({{"vertex", loose.vertex->id()},
                                     {"type", graph.typeOf(*loose.vertex).tag()},
                                     {"directions", loose.directions}});
  }
  return json;
}

/// Unknown numbers less those that nothing determines.
std::int64_t determinedNumbers(const Problem& problem, const Json& freedom) {
  std::int64_t count = 0;
  for (int v = 0; v < problem.variables(); ++v)
    count += problem.dimension(v) - std::popcount(problem.heldDirections(v));
  for (const Json& gauge : freedom["gauge"]) count -= gauge["free_directions"].get<std::int64_t>();
  for (const Json& loose : freedom["unconstrained"]) count -= static_cast<std::int64_t>(loose["directions"].size());
  return count;
}

/// What `optimize` would decide: it is asked to, and to take no step.
Json describePlan(Graph graph, int threads) {
  Options options;
  options.maxIterations = 0;
  options.threads = threads;
  Optimizer optimizer(options);
  const InitialGuess guess = makeInitialGuess(graph, "auto", optimizer);
  const std::int64_t bytes = estimateMemory(graph, options);  // what --memory-limit must allow
  const Summary& summary = optimizer.optimize(graph);
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
          {"bytes", bytes}};
}

/// The keys of describeResiduals() and describeFreedom() where there is nothing to evaluate at.
Json describeUnknown() {
  const Json none = Json::array();
  return {{"chi2", nullptr},
          {"cost", nullptr},
          {"undefined", none},
          {"worst_edges", none},
          {"redundancy",
           {{"measured", nullptr}, {"determined", nullptr}, {"degrees_of_freedom", nullptr}, {"p_value", nullptr}}},
          {"gates", none},
          {"suspects_judged", false},
          {"suspects", none},
          {"gauge", none},
          {"unconstrained", none}};
}

/// Whether every vertex that an edge touches has an estimate.
bool canBeEvaluated(const GraphSurvey& survey) {
  return std::includes(survey.isolated.begin(), survey.isolated.end(), survey.withoutEstimate.begin(),
                       survey.withoutEstimate.end());
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

void info(const Flags& flags) {
  checkOutputs({flags.json});
  checkInputsSpared({flags.json}, {flags.source.path});
  LongWork longWork(false);
  longWork.reading(flags.source.path);
  LoadedGraph loaded = loadGraph(flags.source);
  longWork.expect(loaded.graph);
  for (const std::string& note : readingNotes(flags.source, loaded.report)) tell(stderr, "{}\n", note);
  Json json;
  json["quiver"] = QUIVER_VERSION;
  json["input"] = describeInput(flags.source, loaded);
  if (flags.dialect == Dialect::logarithm) loaded.graph = withLogarithmicEdges(loaded.graph);
  Graph& graph = loaded.graph;
  longWork.tell("counting, components and bridges");
  const GraphSurvey survey = surveyGraph(graph);
  json.update(describeSurvey(survey));
  json.update(describeConnections(graph));
  json["information"] = loaded.report.clampedInformation == 0
                            ? "every matrix is finite, symmetric and positive semi-definite"
                            : counted(loaded.report.clampedInformation, "matrix was", "matrices were") + " repaired";
  if (canBeEvaluated(survey)) {
    longWork.tell("directions that nothing holds, residuals");
    const Problem problem(graph, {.level = -1, .free = {}, .threads = flags.source.threads});
    const Json freedom = describeFreedom(graph, problem);
    json.update(describeResiduals(graph, determinedNumbers(problem, freedom), flags.worst));
    json.update(freedom);
  } else {
    json.update(describeUnknown());
  }
  if (Json depth = describeDepth(graph); !depth.is_null()) json["depth"] = std::move(depth);
  if (flags.plan) longWork.tell("planning the solve");
  if (flags.plan) {
    json["plan"] = naming(displayName(flags.source.path), [&] { return describePlan(graph, flags.source.threads); });
  }
  if (!flags.json.empty()) saveJson(flags.json, json);
  if (flags.json == "-") return;
  printInfo(json);
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
      ->transform(wholeNumber(0, 1000000))
      ->capture_default_str();
  command->add_option("--json", flags->json, "Write all of it as JSON here (- is standard output)")
      ->type_name("FILE")
      ->check(outputPath());
  command->footer("Examples:\n  quiver info city.g2o\n  quiver info city.g2o --plan --worst 20 --json city.json");
  command->callback([flags] { info(*flags); });
}

}  // namespace quiver::app
