#include <algorithm>

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/core/registry/conformance.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

struct Flags {
  std::vector<std::string> plugins;
  bool builtin = false;
  std::string json;
  ConformanceOptions options;
};

std::vector<std::string> tagsOf(const Registry& registry) {
  std::vector<std::string> tags;
  for (const auto& type : registry.vertexTypes()) tags.push_back(type->tag());
  for (const auto& type : registry.parameterTypes()) tags.push_back(type->tag());
  for (const auto& type : registry.edgeTypes()) tags.push_back(type->tag());
  return tags;
}

std::vector<std::string> kernelsOf(const Registry& registry) {
  std::vector<std::string> names;
  for (const RobustKernelType* kernel : registry.robustKernels()) names.emplace_back(kernel->name);
  return names;
}

/// What is in `all` and not in `known`: plugins register behind the rest.
std::vector<std::string> beyond(const std::vector<std::string>& all, const std::vector<std::string>& known) {
  std::vector<std::string> rest;
  for (const std::string& word : all) {
    if (std::find(known.begin(), known.end(), word) == known.end()) rest.push_back(word);
  }
  return rest;
}

/// What is to be checked: types by tag, robust kernels by name.
struct Selection {
  std::vector<std::string> tags;
  std::vector<std::string> kernels;
};

Selection select(const Flags& flags, const Registry& registry) {
  Selection all{tagsOf(registry), kernelsOf(registry)};
  if (!flags.options.tags.empty()) {
    for (const std::string& tag : beyond(flags.options.tags, all.tags))
      throw UsageError(fmt::format("--types: there is no type '{}'; quiver list tells which there are", tag));
    return {flags.options.tags, {}};
  }
  if (flags.builtin) return all;
  const auto builtin = makeRegistry({});
  return {beyond(all.tags, tagsOf(*builtin)), beyond(all.kernels, kernelsOf(*builtin))};
}

Json describeReport(const Selection& selection, const ConformanceReport& report) {
  static constexpr const char* directions[] = {"x", "y", "z", "roll", "pitch", "yaw", "scale"};
  static_assert(std::size(directions) == gaugeDirections);
  Json json;
  json["quiver"] = QUIVER_VERSION;
  json["passed"] = report.passed();
  json["types"] = selection.tags;
  json["robust_kernels"] = selection.kernels;
  json["checks"] = report.checks;
  json["findings"] = Json::array();
  for (const ConformanceFinding& finding : report.findings)
    json["findings"].push_back({{"name", finding.tag}, {"check", finding.check}, {"message", finding.message}});
  json["world_invariance"] = Json::object();
  for (const WorldInvariance& invariance : report.invariances) {
    Json& moves = json["world_invariance"][invariance.tag] = Json::array();
    for (std::size_t i = 0; i < std::size(directions); ++i) {
      if (invariance.directions >> i & 1) moves.push_back(directions[i]);
    }
  }
  return json;
}

void printReport(const Json& json) {
  for (const Json& finding : json["findings"]) {
    tell(stdout, "{}: {}: {}\n", finding["name"].get<std::string>(), finding["check"].get<std::string>(),
         finding["message"].get<std::string>());
  }
  for (const auto& [tag, moves] : json["world_invariance"].items()) {
    const auto words = moves.get<std::vector<std::string>>();
    tell(stdout, "{}: chi2 stays when the world moves in {}\n", tag,
         words.empty() ? "no direction" : fmt::format("{}", fmt::join(words, ", ")));
  }
  tell(stdout, "{} and {}, {}, {}\n", counted(static_cast<std::int64_t>(json["types"].size()), "type"),
       counted(static_cast<std::int64_t>(json["robust_kernels"].size()), "robust kernel"),
       counted(json["checks"].get<std::int64_t>(), "check"),
       counted(static_cast<std::int64_t>(json["findings"].size()), "finding"));
}

int check(Flags& flags) {
  if (flags.plugins.empty() && !flags.builtin) throw UsageError("check what? Name a plugin's file, or --builtin");
  checkOutputs({flags.json});
  const std::shared_ptr<const Registry> registry = makeRegistry(flags.plugins);
  const Selection selection = select(flags, *registry);
  if (selection.tags.empty() && selection.kernels.empty())
    throw GraphError("the plugin registers no type and no robust kernel: there is nothing to check");
  ConformanceReport report;
  flags.options.tags = selection.tags;
  flags.options.approximateJacobians.emplace_back("EDGE_SE3:LOG_APPROXIMATE");  // says so by its name
  if (!selection.tags.empty()) report = checkConformance(registry, flags.options);
  checkKernels(*registry, selection.kernels, report);
  const Json json = describeReport(selection, report);
  if (flags.json != "-") printReport(json);
  if (!flags.json.empty()) saveJson(flags.json, json);
  return report.passed() ? exitSuccess : exitBadInput;
}

}  // namespace

void addCheckCommand(CLI::App& parser, int& exitCode) {
  CLI::App* command = parser.add_subcommand("check", "Check that a plugin's types keep what the library relies on");
  auto flags = std::make_shared<Flags>();
  command->add_option("PLUGIN", flags->plugins, "Shared libraries whose types and robust kernels are checked")
      ->check(inputPath());
  command->add_flag("--builtin", flags->builtin, "Check everything that is built in, and the plugins");
  addList(*command, "--types", flags->options.tags, "Check these types only, by tag", filled("a tag"))
      ->type_name("TAG[,TAG...]");
  command->add_option("--draws", flags->options.draws, "Random elements of each type")
      ->capture_default_str()
      ->check(wholeNumber(1, 100000));
  command->add_option("--seed", flags->options.seed, "Seed of what is made up")
      ->capture_default_str()
      ->check(wholeNumber<std::uint64_t>(0));
  command->add_option("--json", flags->json, "Write the report as JSON here (- is standard output)")
      ->type_name("FILE")
      ->check(outputPath());
  command->footer(
      "On made-up elements: Jacobians agree with differences, also near half a turn; x + 0 = x and the tangent's\n"
      "directions are independent; what is written reads back to the same bits; robust kernels have the\n"
      "derivatives they state. Exit 3 if something is found.\n"
      "Examples:\n  quiver check libbeacons.so\n  quiver check --builtin --types EDGE_SE2 --draws 100");
  command->callback([flags, &exitCode] { exitCode = check(*flags); });
}

}  // namespace quiver::app
