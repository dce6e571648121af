#include <quiver/apps/info/graph_survey.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>

#include <quiver/core/problem/problem.h>

namespace quiver::app {
namespace {

/// Disjoint sets of indices.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

void surveyVertices(const Graph& graph, GraphSurvey& survey) {
  graph.forEachVertex([&](const Vertex& vertex) {
    ++survey.vertices[graph.typeOf(vertex).tag()];
    if (vertex.fixed()) {
      ++survey.fixed;
    } else if (vertex.fixedDirections() != 0) {
      ++survey.partlyFixed;
    }
    if (!vertex.hasEstimate()) survey.withoutEstimate.push_back(vertex.id());
  });
  graph.forEachParameter([&](const Parameter& parameter) { ++survey.parameters[graph.typeOf(parameter).tag()]; });
  std::sort(survey.withoutEstimate.begin(), survey.withoutEstimate.end());
}

void surveyEdges(const Graph& graph, GraphSurvey& survey) {
  std::vector<std::pair<int, std::vector<std::int64_t>>> joined;
  graph.forEachEdge([&](const Edge& edge) {
    const EdgeType& type = graph.typeOf(edge);
    ++survey.edges[type.tag()];
    const auto information = type.information(edge);
    if (std::all_of(information.begin(), information.end(), [](double entry) { return entry == 0.0; }))
      survey.zeroInformation.push_back(edgeName(graph, edge));
    if (edge.robustKernel())
      ++survey.kernels[fmt::format("{} {:g}", edge.robustKernel().name(), edge.robustKernel().width())];
    ++survey.levels[edge.level()];
    std::vector<std::int64_t> ids(edge.vertexIds().begin(), edge.vertexIds().end());
    std::sort(ids.begin(), ids.end());
    joined.emplace_back(edge.type(), std::move(ids));
  });
  std::sort(joined.begin(), joined.end());
  for (std::size_t i = 1; i < joined.size(); ++i) survey.parallel += joined[i] == joined[i - 1];
}

void surveyConnections(const Graph& graph, GraphSurvey& survey) {
  std::unordered_map<std::int64_t, std::size_t> index;
  std::vector<std::int64_t> ids;
  graph.forEachVertex([&](const Vertex& vertex) {
    index.emplace(vertex.id(), ids.size());
    ids.push_back(vertex.id());
  });
  DisjointSets sets(ids.size());
  std::vector<std::int64_t> degree(ids.size(), 0);
  graph.forEachEdge([&](const Edge& edge) {
    const std::size_t first = index.at(edge.vertexId(0));
    for (const std::int64_t id : edge.vertexIds()) {
      const std::size_t vertex = index.at(id);
      ++degree[vertex];
      sets.join(vertex, first);
    }
  });
  std::unordered_map<std::size_t, std::int64_t> sizes;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ++survey.degrees[degree[i]];
    if (degree[i] == 0) {
      survey.isolated.push_back(ids[i]);
    } else {
      ++sizes[sets.find(i)];
    }
  }
  std::sort(survey.isolated.begin(), survey.isolated.end());
  survey.components = static_cast<std::int64_t>(sizes.size());
  for (const auto& [root, size] : sizes) survey.largestComponent = std::max(survey.largestComponent, size);
}

}  // namespace

std::string edgeName(const Graph& graph, const Edge& edge) {
  return fmt::format("{} {}", graph.typeOf(edge).tag(), fmt::join(edge.vertexIds(), " "));
}

GraphSurvey surveyGraph(const Graph& graph) {
  GraphSurvey survey;
  surveyVertices(graph, survey);
  surveyEdges(graph, survey);
  surveyConnections(graph, survey);
  return survey;
}

std::vector<EdgeChi2> evaluateEdges(Graph& graph) {
  const Problem problem(graph, {.level = -1, .free = {}, .threads = 1});
  std::vector<EdgeChi2> result;
  result.reserve(static_cast<std::size_t>(problem.edges()));
  std::vector<std::int32_t> list;
  for (int b = 0; b < problem.batches(); ++b) {
    const EdgeBatch& batch = problem.batch(b);
    PanelBuffer buffer(batch.largestShape(), false);
    const Panel& panel = buffer.panel();
    const int step = batch.uniform() ? Panel::capacity : 1;
    for (int begin = 0; begin < batch.size(); begin += step) {
      list.resize(static_cast<std::size_t>(std::min(step, batch.size() - begin)));
      std::iota(list.begin(), list.end(), begin);
      batch.evaluate(problem.state(), list, panel);
      for (std::size_t i = 0; i < list.size(); ++i)
        result.push_back({&batch.edge(list[i]), panel.squaredError[i], panel.cost[i]});
    }
  }
  return result;
}

}  // namespace quiver::app
