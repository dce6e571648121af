#include <quiver/apps/info/info_text.h>

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <quiver/apps/support/counted.h>
#include <quiver/apps/support/standard_streams.h>

namespace quiver::app {
namespace {

using Json = nlohmann::ordered_json;

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

void printLine(const char* name, const std::string& text) { tell(stdout, "{:<12} {}\n", name, text); }

std::string nameOf(const Json& edge) {
  std::string text = edge["type"].get<std::string>();
  for (const Json& id : edge["vertices"]) text += fmt::format(" {}", id.dump());
  return text;
}

void printBridges(const Json& json) {
  printLine("cycles", counted(json["independent_cycles"].get<std::int64_t>(), "independent one"));
  const Json& bridges = json["bridges"];
  if (bridges.empty()) return;
  const Json& first = bridges[0];
  printLine("bridges", fmt::format("{} without which a component falls apart; {} cuts off {}",
                                   counted(static_cast<std::int64_t>(bridges.size()), "edge"), nameOf(first),
                                   counted(first["cut_off"].get<std::int64_t>(), "vertex", "vertices")));
}

void printStructure(const Json& json) {
  const Json& input = json["input"];
  printLine("file", fmt::format("{} ({}, {} bytes)", input["file"].get<std::string>(),
                                input["format"].get<std::string>(), input["bytes"].get<std::int64_t>()));
  printLine("vertices", countsOf(input["vertices"]));
  printLine("edges", countsOf(input["edges"]));
  if (!json["parameters"].empty()) printLine("parameters", countsOf(json["parameters"]));
  printLine("fixed", fmt::format("{}, in part {}", json["fixed"].get<int>(), json["partly_fixed"].get<int>()));
  printLine("components", fmt::format("{}, the largest of {}", json["components"].get<std::int64_t>(),
                                      counted(json["largest_component"].get<std::int64_t>(), "vertex", "vertices")));
  printLine("degrees", degreesOf(json["degrees"]));
  printBridges(json);
  if (!json["kernels"].empty()) printLine("kernels", countsOf(json["kernels"]));
  if (json["levels"].size() > 1) printLine("levels", countsOf(json["levels"]));
  const auto list = [&json](const char* key, const char* name) {
    if (!json[key].empty()) printLine(name, fmt::format("{}: {}", json[key].size(), firstOf(json[key])));
  };
  list("isolated", "isolated");
  list("without_estimate", "no estimate");
  list("zero_information", "zero weight");
  if (json["parallel_edges"].get<std::int64_t>() > 0)
    printLine("parallel", counted(json["parallel_edges"].get<std::int64_t>(), "edge joins", "edges join") +
                              " the same vertices as another one");
  printLine("information", json["information"].get<std::string>());
}

void printEdges(const Json& edges) {
  for (const Json& edge : edges) {
    printLine("", fmt::format("{:>16.6g}  p {:<8.2g}  {}", edge["chi2"].get<double>(), edge["p_value"].get<double>(),
                              nameOf(edge)));
  }
}

/// Edges of other levels take no part.
bool hasOtherLevels(const Json& levels) { return levels.size() > (levels.contains("0") ? 1U : 0U); }

void printResiduals(const Json& json) {
  const Json& undefined = json["undefined"];
  if (!undefined.empty()) {
    printLine("chi2", fmt::format("not a number because of {}, the first {}",
                                  counted(static_cast<std::int64_t>(undefined.size()), "edge"), nameOf(undefined[0])));
  } else if (json["chi2"].is_null()) {
    printLine("chi2", "infinite");
  } else {
    printLine("chi2", fmt::format("{:.10g}, cost {:.10g}{}", json["chi2"].get<double>(), json["cost"].get<double>(),
                                  hasOtherLevels(json["levels"]) ? ", of the edges of level 0 alone" : ""));
  }
  const Json& redundancy = json["redundancy"];
  const std::string probability =
      redundancy["p_value"].is_null() ? "" : fmt::format(", p {:.2g}", redundancy["p_value"].get<double>());
  printLine("redundancy", fmt::format("{} numbers measured for {} unknown ones; chi2 is to be about {}{}",
                                      redundancy["measured"].dump(), redundancy["determined"].dump(),
                                      redundancy["degrees_of_freedom"].dump(), probability));
  std::string gates;
  for (const Json& gate : json["gates"]) {
    gates += fmt::format("{}{} beyond {:g} % ({:.4g} expected)", gates.empty() ? "" : ", ", gate["beyond"].dump(),
                         100.0 * gate["probability"].get<double>(), gate["expected"].get<double>());
  }
  printLine("gates", gates);
  if (!json["worst_edges"].empty()) printLine("worst", "edges by chi2, and how probable more is");
  printEdges(json["worst_edges"]);
  constexpr std::size_t shown = 10;
  const Json& suspects = json["suspects"];
  if (!json["suspects_judged"].get<bool>()) {
    printLine("suspects", "not told: too many edges misfit for single ones to stand out; optimise first");
  } else if (suspects.empty()) {
    printLine("suspects", "none");
  } else {
    printLine("suspects", fmt::format("{} that the others contradict{}",
                                      counted(static_cast<std::int64_t>(suspects.size()), "edge"),
                                      suspects.size() > shown ? fmt::format(", the first {}", shown) : ""));
    Json first = Json::array();
    for (std::size_t i = 0; i < std::min(shown, suspects.size()); ++i) first.push_back(suspects[i]);
    printEdges(first);
  }
}

void printFreedom(const Json& json) {
  constexpr std::size_t shown = 8;
  const Json& gauges = json["gauge"];
  for (std::size_t i = 0; i < std::min(shown, gauges.size()); ++i) {
    const Json& gauge = gauges[i];
    printLine("gauge", fmt::format("{} in a component of {}{}",
                                   counted(gauge["free_directions"].get<std::int64_t>(), "free direction"),
                                   counted(gauge["vertices"].get<std::int64_t>(), "unknown vertex", "unknown vertices"),
                                   gauge["tested"].get<bool>() ? "" : " (not all could be tested)"));
  }
  if (gauges.size() > shown) printLine("", fmt::format("and {} more components", gauges.size() - shown));
  if (json["unconstrained"].empty()) return;
  const Json& loose = json["unconstrained"];
  printLine("loose", loose.size() == 1
                         ? "1 vertex has directions in which no edge holds it"
                         : fmt::format("{} vertices have directions in which no edge holds them", loose.size()));
  for (std::size_t i = 0; i < std::min(shown, loose.size()); ++i) {
    std::string directions;
    for (const Json& direction : loose[i]["directions"])
      directions += (directions.empty() ? "" : "; ") + direction.get<std::string>();
    printLine("", fmt::format("{} {}: {}", loose[i]["type"].get<std::string>(), loose[i]["vertex"].dump(), directions));
  }
  if (loose.size() > shown) printLine("", fmt::format("and {} more", loose.size() - shown));
}

void printNumbers(const Json& json) {
  if (json.contains("depth") && json["depth"]["behind_camera"].get<std::int64_t>() > 0) {
    const Json& depth = json["depth"];
    printLine("depth", fmt::format("{} of {} observations are of points behind their camera, the first {} {}",
                                   depth["behind_camera"].dump(), depth["observations"].dump(),
                                   depth["first"]["type"].get<std::string>(), depth["first"]["vertices"].dump()));
  }
  if (json["redundancy"]["measured"].is_null()) {
    printLine("chi2", "unknown: vertices have no estimate");
  } else {
    printResiduals(json);
  }
  printFreedom(json);
  if (!json.contains("plan")) return;
  tell(stdout, "plan\n");
  for (const auto& [key, value] : json["plan"].items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!text.empty()) tell(stdout, "  {:<22} {}\n", key, text);
  }
}

}  // namespace

void printInfo(const Json& json) {
  printStructure(json);
  printNumbers(json);
}

}  // namespace quiver::app
