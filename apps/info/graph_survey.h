#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// What a graph's structure and information matrices tell without evaluating anything.
struct GraphSurvey {
  std::map<std::string, std::int64_t> vertices;
  std::map<std::string, std::int64_t> edges;
  std::map<std::string, std::int64_t> parameters;
  std::int64_t fixed = 0;
  std::int64_t partlyFixed = 0;
  /// Connected components, fixed vertices connecting like others; isolated vertices are no component.
  std::int64_t components = 0;
  std::int64_t largestComponent = 0;
  /// degrees[d]: vertices on which d edges are.
  std::map<std::int64_t, std::int64_t> degrees;
  /// Ids, ascending.
  std::vector<std::int64_t> isolated;
  std::vector<std::int64_t> withoutEstimate;
  /// Edges whose information matrix is zero, as "TAG ID ID".
  std::vector<std::string> zeroInformation;
  /// Edges that join the same vertices as an earlier edge of the same type.
  std::int64_t parallel = 0;
  std::map<std::string, std::int64_t> kernels;
  std::map<int, std::int64_t> levels;
};

/// O(edges · log edges).
GraphSurvey surveyGraph(const Graph& graph);

/// "TAG ID ID …"
std::string edgeName(const Graph& graph, const Edge& edge);

/// chi2 of one edge at the graph's estimates.
struct EdgeChi2 {
  const Edge* edge = nullptr;
  double chi2 = 0.0;
  double cost = 0.0;
};

/// chi2 of every edge of every level, in the library's canonical order. Throws GraphError if a vertex has no estimate.
std::vector<EdgeChi2> evaluateEdges(Graph& graph);

}  // namespace quiver::app
