#include <quiver/core/algorithm/algorithms.h>

#include <algorithm>

#include <quiver/core/algorithm/descent.h>

namespace quiver {
namespace {

const std::vector<NamedEntry<Algorithm>>& libraryAlgorithms() {
  static const std::vector<NamedEntry<Algorithm>> algorithms{
      {"gn", "Gauss-Newton: full steps.", {[](Descent& descent) { gaussNewton(descent, false); }, false}},
      {"lm", "Levenberg-Marquardt: damped steps; leaves the gauge free.", {levenbergMarquardt, true}},
      {"dogleg", "Powell's dogleg: steps within a radius, between the gradient and the full step.", {dogleg, false}}};
  return algorithms;
}

}  // namespace

void registerAlgorithms(Registry& registry) {
  for (const auto& entry : libraryAlgorithms()) registry.addAlgorithm(entry.name, entry.documentation, entry.value);
}

const NamedEntry<Algorithm>* findAlgorithm(const Registry& registry, std::string_view name) {
  if (const NamedEntry<Algorithm>* known = registry.findAlgorithm(name)) return known;
  for (const auto& entry : libraryAlgorithms()) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

std::vector<std::string> algorithmNames(const Registry& registry) {
  std::vector<std::string> names{"auto"};
  const auto append = [&](const std::vector<NamedEntry<Algorithm>>& entries) {
    for (const auto& entry : entries) {
      if (std::find(names.begin(), names.end(), entry.name) == names.end()) names.push_back(entry.name);
    }
  };
  append(libraryAlgorithms());
  append(registry.algorithms());
  return names;
}

}  // namespace quiver
