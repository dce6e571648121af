#include <quiver/apps/optimize/robust_choice.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include <quiver/apps/support/flag_checks.h>
#include <quiver/apps/support/outcome.h>
#include <quiver/core/registry/registry.h>

namespace quiver::app {
namespace {

constexpr std::string_view form = "it is NAME[:WIDTH[:SHAPE]], WIDTH a number or p and a probability, as huber:p0.95";

double parseReal(std::string_view text, const std::string& whole) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end || !std::isfinite(value))
    throw UsageError(fmt::format("--robust {}: '{}' is no number; {}", whole, text, form));
  return value;
}

const RobustKernelType& findKernel(const std::string& name, const std::string& whole, const Registry& registry) {
  if (const RobustKernelType* type = registry.findRobustKernel(name)) return *type;
  std::vector<std::string> names;
  for (const RobustKernelType* kernel : registry.robustKernels()) names.emplace_back(kernel->name);
  const std::string near = nearestWord(name, names);
  throw UsageError(fmt::format("--robust {}: no kernel '{}'{}; there are none, {}", whole, name,
                               near.empty() ? "" : fmt::format(", did you mean '{}'", near), fmt::join(names, ", ")));
}

}  // namespace

RobustChoice::RobustChoice(const std::string& text, const Registry& registry) {
  const std::vector<std::string> parts = splitList(text, ':');
  if (parts.size() > 3) throw UsageError(fmt::format("--robust {}: {}", text, form));
  if (parts[0] == "none" && parts.size() == 1) return;
  type_ = &findKernel(parts[0], text, registry);
  shape_ = type_->defaultShape;
  if (parts.size() > 1 && !parts[1].empty() && parts[1][0] == 'p') {
    probability_ = parseReal(std::string_view(parts[1]).substr(1), text);
    if (!(*probability_ > 0.0 && *probability_ < 1.0))
      throw UsageError(fmt::format("--robust {}: the probability must lie between 0 and 1", text));
  } else if (parts.size() > 1) {
    width_ = parseReal(parts[1], text);
    if (!(width_ > 0.0)) throw UsageError(fmt::format("--robust {}: the width must be positive", text));
  }
  if (parts.size() < 3) return;
  if (!type_->hasShape) throw UsageError(fmt::format("--robust {}: the kernel {} has no shape", text, type_->name));
  shape_ = parseReal(parts[2], text);
}

RobustKernel RobustChoice::kernelFor(int dimension) const {
  if (!type_) return RobustKernel();
  return RobustKernel(*type_, probability_ ? type_->widthOf(*probability_, dimension) : width_, shape_);
}

EdgeChoice::EdgeChoice(const std::vector<std::string>& words, const Registry& registry) : words_(words) {
  for (const std::string& word : words_) {
    if (word == "all" || word == "loops") {
      if (words_.size() > 1) throw UsageError(fmt::format("--robust-edges: '{}' stands alone", word));
      continue;
    }
    if (const EdgeType* type = registry.findEdgeType(word)) {
      types_.push_back(type);
      continue;
    }
    std::vector<std::string> tags{"all", "loops"};
    for (const auto& type : registry.edgeTypes()) tags.push_back(type->tag());
    const std::string near = nearestWord(word, tags);
    throw UsageError(fmt::format("--robust-edges {}: no such edge type{}; it is all, loops or tags of edge types", word,
                                 near.empty() ? "" : fmt::format(", did you mean '{}'", near)));
  }
}

bool EdgeChoice::contains(const Graph& graph, const Edge& edge) const {
  if (words_.front() == "all") return true;
  if (loops()) {
    if (edge.arity() < 2) return false;
    const Vertex* from = graph.findVertex(edge.vertexId(0));
    const Vertex* to = graph.findVertex(edge.vertexId(1));
    return from && to && from->type() == to->type() && std::abs(edge.vertexId(0) - edge.vertexId(1)) != 1;
  }
  return std::find(types_.begin(), types_.end(), &graph.typeOf(edge)) != types_.end();
}

}  // namespace quiver::app
