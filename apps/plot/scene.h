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
  std::string title;
  bool spatial = false;
  std::vector<PlanePoint> poses;
  std::vector<PlanePoint> landmarks;
  /// Measurements between poses of consecutive ids.
  std::vector<Segment> odometry;
  /// All other measurements between poses.
  std::vector<Segment> closures;
  /// Measurements between a pose and a landmark.
  std::vector<Segment> sightings;
  double chi2 = 0.0;
  /// Vertices without an estimate, or of types that have no place.
  std::int64_t left = 0;
};

/// Throws GraphError if nothing can be drawn.
Scene makeScene(const Graph& graph, const std::string& title);

}  // namespace quiver::app
