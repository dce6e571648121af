#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <quiver/core/graph/graph.h>
#include <quiver/geometry/se3.h>

namespace quiver {

/// What the keys of a trajectory's poses are.
enum class TrajectoryKey {
  /// Ids of vertices.
  id,
  /// Seconds.
  stamp,
  /// Positions in a file, counted from 0.
  order,
};

struct TrajectoryPose {
  double key = 0.0;
  /// Body to world, metres.
  SE3<double> pose;
};

/// Poses in ascending order of their keys, no key twice.
struct Trajectory {
  TrajectoryKey key = TrajectoryKey::order;
  /// Whether all poses come from vertices of the plane; they lie at z = 0 then.
  bool planar = false;
  std::vector<TrajectoryPose> poses;
};

/// The poses of a graph: vertices whose place is one, VertexType::placeKind(). Throws GraphError if there are none, one
/// of them has no estimate, or an id exceeds 2^53. O(n log n).
Trajectory trajectoryOf(const Graph& graph);

/// Whether a text looks like a trajectory: its first line outside comments begins with a number, and does not consist
/// of three whole ones, as that of a bundle adjustment file does.
bool isTrajectoryText(std::string_view text);

/// Reads a trajectory in one of two formats, told apart by the length of the first line:
///
///     stamp x y z qx qy qz qw      TUM: seconds, metres, unit quaternion (to 1e-2; it is normalised)
///     r11 r12 r13 x r21 … z        KITTI: the upper three rows of the pose's matrix (orthonormal to 1e-3)
///
/// Empty lines and lines that start with # are skipped. Throws ParseError at the first line that is wrong.
Trajectory readTrajectoryText(std::string_view text, const std::string& name);

}  // namespace quiver
