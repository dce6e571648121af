#include <quiver/apps/simulate/wrong_loops.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <quiver/core/problem/canonical_order.h>
#include <quiver/core/util/error.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam3d/edge_se3.h>

namespace quiver::app {
namespace {

using Pair = std::pair<std::int64_t, std::int64_t>;

/// What the graph has of one edge type.
template <typename E>
struct PoseEdges {
  std::vector<typename E::Measurement> measurements;  // of loop closures
  std::vector<Matrix<double, E::errorDimension, E::errorDimension>> informations;
  std::set<Pair> joined;
  std::vector<std::int64_t> poses;

  explicit PoseEdges(const Graph& graph) {
    const EdgeType* type = graph.registry()->findEdgeTypeByName(typeName<E>());
    std::set<std::int64_t> ids;
    std::vector<const Edge*> loops;
    graph.forEachEdge([&](const Edge& edge) {
      if (&graph.typeOf(edge) != type) return;
      const std::int64_t low = std::min(edge.vertexId(0), edge.vertexId(1));
      const std::int64_t high = std::max(edge.vertexId(0), edge.vertexId(1));
      joined.emplace(low, high);
      ids.insert({low, high});
      if (high - low != 1) loops.push_back(&edge);
    });
    sortEdges(graph, loops);  // the order of the file must not matter
    for (const Edge* edge : loops) {
      measurements.push_back(static_cast<const E*>(edge)->measurement());
      informations.push_back(static_cast<const E*>(edge)->information());
    }
    poses.assign(ids.begin(), ids.end());
  }
};

template <typename E>
std::int64_t addWrongEdges(Graph& graph, double fraction, std::mt19937_64& random) {
  PoseEdges<E> edges(graph);
  const auto right = static_cast<double>(edges.measurements.size());
  const auto wanted = static_cast<std::int64_t>(std::llround(fraction * right));
  if (wanted == 0) return 0;
  const auto poses = static_cast<double>(edges.poses.size());
  if (static_cast<double>(wanted) > 0.25 * poses * (poses - 1.0) - static_cast<double>(edges.joined.size()))
    throw GraphError(fmt::format("{} poses have no room for {} wrong loop closures", edges.poses.size(), wanted));
  const auto draw = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  for (std::int64_t added = 0; added < wanted;) {
    const std::int64_t from = edges.poses[draw(edges.poses.size())];
    const std::int64_t to = edges.poses[draw(edges.poses.size())];
    if (std::abs(from - to) <= 1 || !edges.joined.emplace(std::min(from, to), std::max(from, to)).second) continue;
    const std::size_t example = draw(edges.measurements.size());
    graph.addEdge<E>({from, to}, edges.measurements[example], edges.informations[example]);
    ++added;
  }
  return wanted;
}

}  // namespace

std::int64_t addWrongLoops(Graph& graph, double fraction, std::uint64_t seed) {
  if (!(fraction >= 0.0) || !std::isfinite(fraction))
    throw GraphError(fmt::format("a fraction of {} wrong loop closures: it must be 0 or more", fraction));
  std::mt19937_64 random(seed);
  const std::int64_t added =
      addWrongEdges<EdgeSE2>(graph, fraction, random) + addWrongEdges<EdgeSE3>(graph, fraction, random);
  if (added == 0 && fraction > 0.0)
    throw GraphError(
        "no wrong loop closure to add: the graph has none (or too few) that could be taken for an example");
  return added;
}

}  // namespace quiver::app
