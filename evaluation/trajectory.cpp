#include <quiver/evaluation/trajectory.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <quiver/core/util/error.h>
#include <quiver/geometry/packing.h>

namespace quiver {
namespace {

SE3<double> poseOf(PoseKind kind, const double* values) {
  if (kind == PoseKind::space)
    return SE3<double>(values[0], values[1], values[2], values[3], values[4], values[5], values[6]);
  const double half = 0.5 * values[2];
  return SE3<double>(values[0], values[1], 0.0, 0.0, 0.0, std::sin(half), std::cos(half));
}

}  // namespace

Trajectory trajectoryOf(const Graph& graph) {
  constexpr std::int64_t largestExact = std::int64_t{1} << 53;
  Trajectory trajectory;
  trajectory.key = TrajectoryKey::id;
  trajectory.planar = true;
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    const PoseKind kind = type.poseKind();
    if (kind == PoseKind::none) return;
    if (!vertex.hasEstimate())
      throw GraphError(fmt::format("vertex {} has no estimate, so the trajectory is not known", vertex.id()));
    if (vertex.id() > largestExact)
      throw GraphError(fmt::format("vertex id {} is too large for a trajectory's key", vertex.id()));
    if (kind == PoseKind::space) trajectory.planar = false;
    trajectory.poses.push_back({static_cast<double>(vertex.id()), poseOf(kind, type.values(vertex))});
  });
  if (trajectory.poses.empty()) throw GraphError("the graph has no poses, so there is no trajectory to evaluate");
  std::sort(trajectory.poses.begin(), trajectory.poses.end(),
            [](const TrajectoryPose& a, const TrajectoryPose& b) { return a.key < b.key; });
  return trajectory;
}

}  // namespace quiver
