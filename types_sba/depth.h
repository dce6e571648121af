#pragma once

#include <cstdint>
#include <tuple>
#include <utility>

#include <quiver/core/graph/graph.h>

namespace quiver {

/// Whether the point of one observation, an edge of a type with `isDepthPositive`, is in front of its camera at the
/// graph's estimates.
template <typename E>
bool isDepthPositive(const Graph& graph, const E& edge) {
  return
      [&]<typename... V, typename... P, int... I, int... A>(
          std::tuple<V...>*, ParameterList<P...>*, std::integer_sequence<int, I...>, std::integer_sequence<int, A...>) {
        return E::isDepthPositive(edge.measurement(),
                                  static_cast<const P&>(*graph.findParameter(edge.parameterIds()[A])).value()...,
                                  static_cast<const V&>(*graph.findVertex(edge.vertexId(I))).estimate()...);
      }(static_cast<typename E::VertexTypes*>(nullptr), static_cast<typename E::Parameters*>(nullptr),
        std::make_integer_sequence<int, static_cast<int>(std::tuple_size_v<typename E::VertexTypes>)>(),
        std::make_integer_sequence<int, E::Parameters::size>());
}

/// Observations of points by cameras, and those whose point is not in front of the camera.
struct DepthSurvey {
  std::int64_t observations = 0;
  std::int64_t behind = 0;
  /// The first of them in the order of the graph.
  const Edge* first = nullptr;
};

/// Looks at all edges of the types that registerSba() adds and that have a point before a camera, where every vertex
/// has an estimate. O(edges).
DepthSurvey surveyDepth(const Graph& graph);

}  // namespace quiver
