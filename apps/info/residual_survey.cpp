#include <quiver/apps/info/residual_survey.h>

#include <algorithm>
#include <cmath>

#include <quiver/core/util/chi_squared.h>

namespace quiver::app {
namespace {

/// A positive semi-definite matrix with a zero on its diagonal has zeros in that row.
int weightedDimension(const Graph& graph, const Edge& edge) {
  const EdgeType& type = graph.typeOf(edge);
  const std::span<const double> triangle = type.information(edge);
  const int rows = type.errorDimension(edge);
  int count = 0;
  std::size_t at = 0;
  for (int row = 0; row < rows; ++row) {
    count += triangle[at] != 0.0;
    at += static_cast<std::size_t>(rows - row);
  }
  return count;
}

/// Above this share of edges beyond the gate of 99 %, single ones cannot be told from the rest.
constexpr double mostBeyond = 0.1;
constexpr double falseAlarm = 0.001;

}  // namespace

ResidualSurvey surveyResiduals(Graph& graph, std::int64_t determined, int worst) {
  ResidualSurvey survey;
  survey.gates = {{{0.95, 0, 0.0}, {0.99, 0, 0.0}, {0.999, 0, 0.0}}};
  std::vector<EdgeProbability> edges;
  for (const EdgeChi2& entry : evaluateEdges(graph)) {
    if (entry.edge->level() != 0) continue;  // takes no part in `optimize` either
    survey.chi2 += entry.chi2;
    survey.cost += entry.cost;
    if (std::isnan(entry.chi2)) {
      survey.undefined.push_back(entry.edge);
      continue;
    }
    const int dimension = weightedDimension(graph, *entry.edge);
    survey.measured += dimension;
    if (dimension == 0) continue;
    edges.push_back({entry.edge, entry.chi2, dimension, chiSquaredTail(entry.chi2, dimension)});
    for (Gate& gate : survey.gates) {
      gate.beyond += edges.back().pValue < 1.0 - gate.probability;
      gate.expected += 1.0 - gate.probability;
    }
  }
  survey.determined = determined;
  survey.degreesOfFreedom = std::max<std::int64_t>(0, survey.measured - determined);
  if (std::isnan(survey.chi2)) {
    survey.pValue = survey.chi2;
  } else if (survey.degreesOfFreedom > 0) {
    survey.pValue = chiSquaredTail(survey.chi2, static_cast<int>(survey.degreesOfFreedom));
  }

  const auto count = static_cast<double>(edges.size());
  survey.judged = static_cast<double>(survey.gates[1].beyond) <= mostBeyond * count;
  if (survey.judged) {
    for (const EdgeProbability& edge : edges) {
      if (edge.pValue * count < falseAlarm) survey.suspects.push_back(edge);
    }
    std::stable_sort(survey.suspects.begin(), survey.suspects.end(),
                     [](const auto& a, const auto& b) { return a.pValue < b.pValue; });
  }
  std::stable_sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.chi2 > b.chi2; });
  edges.resize(std::min(edges.size(), static_cast<std::size_t>(worst)));
  survey.worst = std::move(edges);
  return survey;
}

}  // namespace quiver::app
