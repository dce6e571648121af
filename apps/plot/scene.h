#pragma once

#include <string>
#include <vector>

#include <quiver/core/graph/graph.h>

namespace quiver::app {

/// A point of the picture's plane: x to the right, y up, in metres.
struct PlanePoint {
  double x = 0.0;
  double y = 0.0;
};

struct Segment {
  PlanePoint from;
  PlanePoint to;
  /// chi2 over the error's dimension: about 1 where the measurement fits its information.
  double misfit = 0.0;
};

/// What of a graph can be drawn, projected to a plane: the plane's own axes for planar graphs, an isometric view for
/// spatial ones.
struct Scene {
  /// What stands above the picture; the caller's.
  std::string title;
  bool spatial = false;
  std::vector<PlanePoint> poses;
  /// Those of them that no measurement joins to another pose, as cameras that share but what they see.
  std::vector<PlanePoint> lonePoses;
  std::vector<PlanePoint> landmarks;
  /// Measurements between poses of consecutive ids.
  std::vector<Segment> odometry;
  /// All other measurements between poses.
  std::vector<Segment> closures;
  /// Measurements of landmarks: a segment from the pose to each.
  std::vector<Segment> sightings;
  double chi2 = 0.0;
  /// Vertices without an estimate; those of types that have no place, or points whose depth is not positive.
  std::int64_t withoutEstimate = 0;
  std::int64_t withoutPlace = 0;
};

/// Throws GraphError if no vertex has a place and an estimate.
Scene makeScene(const Graph& graph);

}  // namespace quiver::app
