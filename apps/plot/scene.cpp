#include <quiver/apps/plot/scene.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include <quiver/apps/info/graph_survey.h>
#include <quiver/core/util/error.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>
#include <quiver/types_slam3d/vertex_se3.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver::app {
namespace {

struct Place {
  PlanePoint point;
  bool pose = false;
};

/// The classical isometric view: x to the lower right, y to the upper right, z up.
PlanePoint isometric(double x, double y, double z) {
  const double c = std::cos(std::numbers::pi / 6.0);
  const double s = std::sin(std::numbers::pi / 6.0);
  return {c * (x + y), s * (y - x) + z};
}

/// Where vertices are; types that have no place in the plane or in space are left out.
class Placer {
 public:
  explicit Placer(const Registry& registry)
      : se2_(registry.findVertexTypeByName(typeName<VertexSE2>())),
        xy_(registry.findVertexTypeByName(typeName<VertexXY>())),
        se3_(registry.findVertexTypeByName(typeName<VertexSE3>())),
        xyz_(registry.findVertexTypeByName(typeName<VertexXYZ>())) {}

  bool spatial(const VertexType& type) const { return &type == se3_ || &type == xyz_; }
  std::optional<Place> place(const VertexType& type, const Vertex& vertex) const {
    if (!vertex.hasEstimate()) return std::nullopt;
    const double* x = type.values(vertex);
    if (&type == se2_ || &type == xy_) return Place{{x[0], x[1]}, &type == se2_};
    if (&type == se3_) {
      const Vector<double, 3> t = estimateOf<VertexSE3>(vertex).translation();
      return Place{isometric(t[0], t[1], t[2]), true};
    }
    if (&type == xyz_) return Place{isometric(x[0], x[1], x[2]), false};
    return std::nullopt;
  }

 private:
  const VertexType* se2_;
  const VertexType* xy_;
  const VertexType* se3_;
  const VertexType* xyz_;
};

using Places = std::unordered_map<std::int64_t, Place>;

void addSegment(const Edge& edge, double misfit, const Places& places, Scene& scene) {
  if (edge.arity() != 2) return;
  const auto first = places.find(edge.vertexId(0));
  const auto second = places.find(edge.vertexId(1));
  if (first == places.end() || second == places.end()) return;
  const Segment segment{first->second.point, second->second.point, misfit};
  if (first->second.pose != second->second.pose) {
    scene.sightings.push_back(segment);
  } else if (first->second.pose) {
    const bool consecutive = std::abs(edge.vertexId(0) - edge.vertexId(1)) == 1;
    (consecutive ? scene.odometry : scene.closures).push_back(segment);
  }
}

void addEdges(const Graph& graph, const Places& places, Scene& scene) {
  bool complete = true;
  graph.forEachVertex([&complete](const Vertex& vertex) { complete = complete && vertex.hasEstimate(); });
  if (!complete) {
    scene.chi2 = std::numeric_limits<double>::quiet_NaN();
    graph.forEachEdge([&](const Edge& edge) { addSegment(edge, 0.0, places, scene); });
    return;
  }
  Graph copy(graph);
  for (const EdgeChi2& edge : evaluateEdges(copy)) {
    scene.chi2 += edge.chi2;
    const int dimension = copy.typeOf(*edge.edge).errorDimension(*edge.edge);
    addSegment(*edge.edge, edge.chi2 / std::max(dimension, 1), places, scene);
  }
}

}  // namespace

Scene makeScene(const Graph& graph, const std::string& title) {
  Scene scene;
  scene.title = title;
  const Placer placer(*graph.registry());
  Places places;
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    const std::optional<Place> place = placer.place(type, vertex);
    if (!place || !std::isfinite(place->point.x) || !std::isfinite(place->point.y)) {
      ++scene.left;
      return;
    }
    places.emplace(vertex.id(), *place);
    (place->pose ? scene.poses : scene.landmarks).push_back(place->point);
    scene.spatial = scene.spatial || placer.spatial(type);
  });
  if (places.empty())
    throw GraphError(fmt::format("{}: nothing to draw: no vertex has a place and an estimate", title));
  addEdges(graph, places, scene);
  return scene;
}

}  // namespace quiver::app
