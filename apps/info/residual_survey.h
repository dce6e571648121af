#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <quiver/apps/info/graph_survey.h>

namespace quiver::app {

/// How many edges lie beyond a gate of chi2, and how many would if errors had the stated noise.
struct Gate {
  double probability = 0.0;
  std::int64_t beyond = 0;
  double expected = 0.0;
};

struct EdgeProbability {
  const Edge* edge = nullptr;
  double chi2 = 0.0;
  /// Numbers of the error that carry weight.
  int dimension = 0;
  /// That chi2 is as large or larger, with the stated noise.
  double pValue = 1.0;
};

/// What the residuals of the edges that `optimize` takes (level 0) say at the graph's estimates about the measurements.
struct ResidualSurvey {
  double chi2 = 0.0;
  double cost = 0.0;
  /// Numbers measured, unknown numbers that they determine, and the difference: what chi2 is to be on average.
  std::int64_t measured = 0;
  std::int64_t determined = 0;
  std::int64_t degreesOfFreedom = 0;
  /// Of chi2 as a whole; 1 where nothing is redundant, not a number where chi2 is not.
  double pValue = 1.0;
  std::array<Gate, 3> gates;
  /// Largest chi2 first.
  std::vector<EdgeProbability> worst;
  /// Whether the estimates fit well enough for single edges to be suspected.
  bool judged = false;
  /// Edges whose chi2 is not a number; they are counted nowhere else, but chi2 is none either.
  std::vector<const Edge*> undefined;
  /// Edges so bad that one among all would be with probability 0.001 only; least p-value first.
  std::vector<EdgeProbability> suspects;
};

/// `determined` as in the result, `worst` the number of edges wanted. Throws GraphError if a vertex has no estimate.
ResidualSurvey surveyResiduals(Graph& graph, std::int64_t determined, int worst);

}  // namespace quiver::app
