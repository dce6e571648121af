#include <quiver/apps/support/initial_guess.h>

#include <limits>

#include <fmt/format.h>

#include <quiver/apps/support/outcome.h>
#include <quiver/core/problem/problem.h>
#include <quiver/initialization/automatic.h>

namespace quiver::app {
namespace {

struct Missing {
  std::int64_t count = 0;
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  std::string type;
};

Missing missingEstimates(const Graph& graph) {
  Missing missing;
  graph.forEachVertex([&](const Vertex& vertex) {
    if (vertex.hasEstimate()) return;
    ++missing.count;
    if (vertex.id() > missing.first) return;
    missing.first = vertex.id();
    missing.type = graph.typeOf(vertex).tag();
  });
  return missing;
}

void refuseMissing(const Graph& graph, const std::string& advice) {
  const Missing missing = missingEstimates(graph);
  if (missing.count == 0) return;
  throw GraphError(fmt::format("vertex {} ({}) has no estimate; {} of {} vertices have none; {}", missing.first,
                               missing.type, missing.count, graph.vertexCount(), advice));
}

}  // namespace

std::int64_t verticesWithoutEstimate(const Graph& graph) { return missingEstimates(graph).count; }

void checkInitialGuess(const std::string& name, const Registry& registry) {
  if (name == "file" || registry.findInitializer(name)) return;
  std::vector<std::string> names{"file"};
  for (const auto& entry : registry.initializers()) names.push_back(entry.name);
  const std::string near = nearestWord(name, names);
  throw UsageError(fmt::format("--init {}: no such initial guess{}; there are {}", name,
                               near.empty() ? "" : fmt::format(", did you mean '{}'", near), fmt::join(names, ", ")));
}

InitialGuess makeInitialGuess(Graph& graph, const std::string& name, Optimizer& optimizer) {
  if (name == "file") {
    refuseMissing(graph, "use --init tree, or let --init auto choose");
    return {"file", "as asked"};
  }
  if (name == "auto") {
    const bool complete = verticesWithoutEstimate(graph) == 0;
    AutomaticStart start = automaticStart(graph, optimizer);
    InitialGuess guess{std::move(start.name), std::move(start.reason)};
    if (complete && guess.name != "file") guess.fileChi2 = start.firstChi2;
    return guess;
  }
  const Initializer* initializer = graph.registry()->findInitializer(name);
  if (!initializer) throw GraphError(fmt::format("the registry has no initialiser '{}'", name));
  InitialGuess guess{name, ""};
  if (verticesWithoutEstimate(graph) == 0) {
    Problem& problem = optimizer.compile(graph);
    guess.fileChi2 = problem.evaluate(problem.state()).chi2;
  }
  guess.reason = (*initializer)(graph, optimizer.options());
  refuseMissing(graph, fmt::format("the initial guess '{}' does not tell it", name));
  return guess;
}

}  // namespace quiver::app
