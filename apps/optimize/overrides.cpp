#include <quiver/apps/optimize/overrides.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include <quiver/apps/support/outcome.h>

namespace quiver::app {
namespace {

std::vector<std::string> splitAtColons(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::string kernelNames(const Registry& registry) {
  std::string names = "none";
  for (const RobustKernelType* kernel : registry.robustKernels()) names += fmt::format(", {}", kernel->name);
  return names;
}

double parseReal(const std::string& text, const std::string& whole) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end || !std::isfinite(value))
    throw UsageError(fmt::format("--robust {}: '{}' is no number; it is NAME[:WIDTH[:SHAPE]]", whole, text));
  return value;
}

}  // namespace

RobustKernel parseRobustKernel(const std::string& text, const Registry& registry) {
  const std::vector<std::string> parts = splitAtColons(text);
  if (parts.size() > 3) throw UsageError(fmt::format("--robust {}: it is NAME[:WIDTH[:SHAPE]]", text));
  if (parts[0] == "none" && parts.size() == 1) return RobustKernel();
  const RobustKernelType* type = registry.findRobustKernel(parts[0]);
  if (!type) {
    std::vector<std::string> names;
    for (const RobustKernelType* kernel : registry.robustKernels()) names.emplace_back(kernel->name);
    const std::string near = nearestWord(parts[0], names);
    throw UsageError(fmt::format("--robust {}: no kernel '{}'{}; there are {}", text, parts[0],
                                 near.empty() ? "" : fmt::format(", did you mean '{}'", near), kernelNames(registry)));
  }
  const double width = parts.size() > 1 ? parseReal(parts[1], text) : 1.0;
  if (!(width > 0.0)) throw UsageError(fmt::format("--robust {}: the width must be positive", text));
  if (parts.size() < 3) return RobustKernel(*type, width);
  if (!type->hasShape) throw UsageError(fmt::format("--robust {}: the kernel {} has no shape", text, type->name));
  return RobustKernel(*type, width, parseReal(parts[2], text));
}

void Overrides::fix(const std::vector<std::int64_t>& ids) {
  for (const std::int64_t id : ids) {
    Vertex* vertex = graph_.findVertex(id);
    if (!vertex) throw GraphError(fmt::format("--fix {}: the graph has no vertex {}", id, id));
    fixed_.emplace_back(id, vertex->fixedDirections());
    vertex->setFixed(true);
  }
}

void Overrides::setRobustKernel(const RobustKernel& kernel) {
  graph_.forEachEdge([&](Edge& edge) {
    kernels_.push_back(edge.robustKernel());
    edge.setRobustKernel(kernel);
  });
}

void Overrides::takeBack() {
  // Backwards: an id may have been named twice.
  for (auto it = fixed_.rbegin(); it != fixed_.rend(); ++it)
    graph_.findVertex(it->first)->setFixedDirections(it->second);
  fixed_.clear();
  if (kernels_.empty()) return;
  std::size_t next = 0;
  graph_.forEachEdge([&](Edge& edge) { edge.setRobustKernel(kernels_[next++]); });
  kernels_.clear();
}

}  // namespace quiver::app
