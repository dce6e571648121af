#include <quiver/evaluation/trajectory.h>

#include <algorithm>

#include <fmt/format.h>

#include <quiver/core/util/error.h>

namespace quiver {

Trajectory trajectoryOf(const Graph& graph) {
  constexpr std::int64_t largestExact = std::int64_t{1} << 53;
  Trajectory trajectory;
  trajectory.key = TrajectoryKey::id;
  trajectory.planar = true;
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    if (!isPose(type.placeKind())) return;
    if (!vertex.hasEstimate())
      throw GraphError(fmt::format("vertex {} has no estimate, so the trajectory is not known", vertex.id()));
    if (vertex.id() > largestExact)
      throw GraphError(fmt::format("vertex id {} is too large for a trajectory's key", vertex.id()));
    if (!isPlanar(type.placeKind())) trajectory.planar = false;
    trajectory.poses.push_back({static_cast<double>(vertex.id()), type.place(type.values(vertex))});
  });
  if (trajectory.poses.empty()) throw GraphError("the graph has no poses, so there is no trajectory to evaluate");
  std::sort(trajectory.poses.begin(), trajectory.poses.end(),
            [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.key < b.key; });
  return trajectory;
}

}  // namespace quiver
