#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <quiver/apps/commands.h>
#include <quiver/apps/list/types_markdown.h>
#include <quiver/apps/optimize/solver_names.h>
#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/graph_source.h>
#include <quiver/apps/support/output.h>
#include <quiver/apps/support/standard_streams.h>
#include <quiver/version.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

Json describeElement(const ElementType& type) {
  Json json;
  json["tag"] = type.tag();
  json["documentation"] = type.documentation();
  json["fields"] = Json::array();
  for (const Field& field : type.fields())
    json["fields"].push_back({{"name", field.name}, {"unit", field.unit}, {"documentation", field.documentation}});
  for (const Field& field : type.tailFields())
    json["tail_fields"].push_back({{"name", field.name}, {"unit", field.unit}, {"documentation", field.documentation}});
  return json;
}

Json dimensionOf(int dimension) { return dimension < 0 ? Json("dynamic") : Json(dimension); }

Json describeVertex(const VertexType& type) {
  Json json = describeElement(type);
  json["dimension"] = dimensionOf(type.dimension());
  if (type.dimension() > 0) json["tangent"] = type.tangentNames(type.dimension());
  return json;
}

std::string tagOf(const Registry& registry, std::string_view cppName) {
  if (const VertexType* type = registry.findVertexTypeByName(cppName)) return type->tag();
  if (const ParameterType* type = registry.findParameterTypeByName(cppName)) return type->tag();
  return std::string(cppName);
}

const char* nameOf(Jacobians jacobians) {
  switch (jacobians) {
    case Jacobians::automatic:
      return "automatic";
    case Jacobians::analytic:
      return "analytic";
    case Jacobians::dual:
      return "dual numbers";
    case Jacobians::numeric:
      return "numeric";
  }
  return "";
}

Json describeEdge(const EdgeType& type, const Registry& registry) {
  Json json = describeElement(type);
  json["dimension"] = dimensionOf(type.errorDimension());
  json["vertices"] = Json::array();
  for (int role = 0; role < type.arity(); ++role)
    json["vertices"].push_back(tagOf(registry, type.vertexTypeName(role)));
  json["any_number_of_the_last"] = type.variableArity();
  json["parameters"] = Json::array();
  for (const std::string_view name : type.parameterTypeNames()) json["parameters"].push_back(tagOf(registry, name));
  json["information"] = type.hasInformationField();
  const EdgeForm form = type.form();
  json["jacobians"] = nameOf(form.jacobians);
  json["lanes"] = form.lanes;
  json["form_reason"] = form.reason;
  return json;
}

template <typename Entries>
Json describeNamed(const Entries& entries) {
  Json json = Json::array();
  for (const auto& entry : entries) json.push_back({{"name", entry.name}, {"documentation", entry.documentation}});
  return json;
}

Json describeRegistry(const Registry& registry) {
  Json json;
  json["quiver"] = QUIVER_VERSION;
  for (const char* key : {"vertices", "edges", "parameters"}) json[key] = Json::array();
  for (const auto& type : registry.vertexTypes()) json["vertices"].push_back(describeVertex(*type));
  for (const auto& type : registry.edgeTypes()) json["edges"].push_back(describeEdge(*type, registry));
  for (const auto& type : registry.parameterTypes()) json["parameters"].push_back(describeElement(*type));
  json["aliases"] = Json::object();
  for (const auto& [alias, tag] : registry.aliases()) json["aliases"][alias] = tag;
  json["data"] = describeNamed(registry.dataTags());
  json["algorithms"] = describeNamed(registry.algorithms());
  json["linear_solvers"] = describeNamed(registry.linearSystems());
  json["initializers"] = describeNamed(registry.initializers());
  json["robust_kernels"] = Json::array();
  for (const RobustKernelType* kernel : registry.robustKernels()) {
    json["robust_kernels"].push_back({{"name", kernel->name},
                                      {"documentation", kernel->documentation},
                                      {"shape", kernel->hasShape ? Json(kernel->defaultShape) : Json(nullptr)}});
  }
  json["solver_names"] = Json::array();
  for (const SolverName& entry : solverNames()) {
    json["solver_names"].push_back({{"name", entry.name},
                                    {"algorithm", entry.algorithm},
                                    {"solver", entry.solver},
                                    {"documentation", fmt::format("{} with {}", entry.algorithm, entry.solver)}});
  }
  return json;
}

std::string words(const Json& list) {
  std::string text;
  for (const Json& word : list) text += (text.empty() ? "" : ", ") + word.template get<std::string>();
  return text;
}

std::string fieldNames(const Json& list) {
  std::string fields;
  for (const Json& field : list) {
    const auto unit = field["unit"].get<std::string>();
    fields += fmt::format("{}{}{}", fields.empty() ? "" : " ", field["name"].get<std::string>(),
                          unit.empty() ? "" : fmt::format("[{}]", unit));
  }
  return fields;
}

void printElement(const Json& type) {
  tell(stdout, "  {}\n", type["tag"].get<std::string>());
  if (type.contains("vertices")) {
    tell(stdout, "      joins {}{}\n", words(type["vertices"]),
         type["any_number_of_the_last"].get<bool>() ? ", and any number more of the last" : "");
    if (!type["parameters"].empty()) tell(stdout, "      parameters {}\n", words(type["parameters"]));
  }
  std::string fields = fieldNames(type["fields"]);
  if (type.contains("information") && type["information"].get<bool>()) fields += " information(upper triangle)";
  if (type.contains("tail_fields")) fields += " " + fieldNames(type["tail_fields"]);
  if (!fields.empty()) tell(stdout, "      fields {}\n", fields);
  if (type.contains("tangent")) tell(stdout, "      tangent {}\n", words(type["tangent"]));
  if (type.contains("jacobians")) {
    tell(stdout, "      error of dimension {}, Jacobians {}{}\n", type["dimension"].dump(),
         type["jacobians"].get<std::string>(), type["lanes"].get<bool>() ? ", eight edges at a time" : "");
  }
  const auto documentation = type["documentation"].get<std::string>();
  if (!documentation.empty()) tell(stdout, "      {}\n", documentation);
}

void printRegistry(const Json& json) {
  for (const char* key : {"vertices", "edges", "parameters"}) {
    tell(stdout, "{}\n", key);
    for (const Json& type : json[key]) printElement(type);
  }
  tell(stdout, "other tags\n");
  for (const auto& [alias, tag] : json["aliases"].items())
    tell(stdout, "  {:<28} read as {}\n", alias, tag.get<std::string>());
  for (const Json& entry : json["data"])
    tell(stdout, "  {:<28} {}\n", entry["name"].get<std::string>(), entry["documentation"].get<std::string>());
  for (const auto& [key, title] :
       {std::pair("algorithms", "algorithms (--algorithm)"), std::pair("linear_solvers", "linear solvers (--solver)"),
        std::pair("initializers", "initial guesses (--init)"), std::pair("robust_kernels", "robust kernels (--robust)"),
        std::pair("solver_names", "g2o's solver names (--algorithm)")}) {
    tell(stdout, "{}\n", title);
    for (const Json& entry : json[key])
      tell(stdout, "  {:<20} {}\n", entry["name"].get<std::string>(), entry["documentation"].get<std::string>());
  }
}

struct Flags {
  std::vector<std::string> plugins;
  std::string json;
  bool markdown = false;
};

}  // namespace

void addListCommand(CLI::App& parser, int&) {
  CLI::App* command = parser.add_subcommand("list", "List the types, solvers, initial guesses and kernels there are");
  auto flags = std::make_shared<Flags>();
  addPluginOption(*command, flags->plugins);
  command->add_option("--json", flags->json, "Write the list as JSON here (- is standard output)")
      ->type_name("FILE")
      ->check(outputPath());
  command->add_flag("--markdown", flags->markdown, "Write the types as tables in Markdown (docs/types.md)");
  command->footer("Examples:\n  quiver list\n  quiver list --plugin libbeacons.so --json -");
  command->callback([flags] {
    checkOutputs({flags->json, flags->markdown ? "-" : ""});
    const Json json = describeRegistry(*makeRegistry(flags->plugins));
    if (flags->markdown) tell(stdout, "{}", typesAsMarkdown(json));
    if (flags->json.empty()) {
      if (!flags->markdown) printRegistry(json);
    } else {
      saveJson(flags->json, json);
    }
  });
}

}  // namespace quiver::app
