#include <quiver/apps/plot/scene.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <fmt/format.h>

#include <quiver/apps/info/graph_survey.h>
#include <quiver/apps/plot/anchored_points.h>
#include <quiver/apps/support/counted.h>
#include <quiver/core/util/error.h>

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

/// Of a vertex with an estimate, of a type that has a place of its own.
Place ownPlace(const VertexType& type, const Vertex& vertex) {
  const Vector<double, 3> t = type.place(type.values(vertex)).translation();
  return {isPlanar(type.placeKind()) ? PlanePoint{t[0], t[1]} : isometric(t[0], t[1], t[2]), isPose(type.placeKind())};
}

using Places = std::unordered_map<std::int64_t, Place>;

/// Adds the segments of edges to a scene.
class SegmentCollector {
 public:
  SegmentCollector(const Places& places, Scene& scene) : places_(places), scene_(scene) {}

  void add(const Edge& edge, double misfit) {
    poses_.clear();
    landmarks_.clear();
    for (const std::int64_t id : edge.vertexIds()) {
      const auto found = places_.find(id);
      if (found != places_.end()) (found->second.pose ? poses_ : landmarks_).push_back(id);
    }
    if (!landmarks_.empty()) {
      // Further poses are those of a sensor on the first one, or of a landmark's anchor.
      if (poses_.empty()) return;
      for (const std::int64_t id : landmarks_) scene_.sightings.push_back({point(poses_[0]), point(id), misfit});
    } else if (poses_.size() == 2 && edge.arity() == 2) {
      const bool consecutive = std::abs(poses_[0] - poses_[1]) == 1;
      (consecutive ? scene_.odometry : scene_.closures).push_back({point(poses_[0]), point(poses_[1]), misfit});
      joined_.insert(poses_.begin(), poses_.end());
    }
  }
  void finish() {
    std::vector<std::int64_t> lone;
    for (const auto& [id, place] : places_) {
      if (place.pose && !joined_.contains(id)) lone.push_back(id);
    }
    std::sort(lone.begin(), lone.end());
    for (const std::int64_t id : lone) scene_.lonePoses.push_back(point(id));
  }

 private:
  const PlanePoint& point(std::int64_t id) const { return places_.at(id).point; }

  const Places& places_;
  Scene& scene_;
  std::unordered_set<std::int64_t> joined_;
  std::vector<std::int64_t> poses_;
  std::vector<std::int64_t> landmarks_;
};

void addEdges(const Graph& graph, const Places& places, Scene& scene) {
  SegmentCollector collector(places, scene);
  if (scene.withoutEstimate > 0) {
    scene.chi2 = std::numeric_limits<double>::quiet_NaN();
    graph.forEachEdge([&](const Edge& edge) { collector.add(edge, 0.0); });
    return collector.finish();
  }
  Graph copy(graph);
  for (const EdgeChi2& edge : evaluateEdges(copy)) {
    scene.chi2 += edge.chi2;
    const int dimension = copy.typeOf(*edge.edge).errorDimension(*edge.edge);
    collector.add(*edge.edge, edge.chi2 / std::max(dimension, 1));
  }
  collector.finish();
}

}  // namespace

Scene makeScene(const Graph& graph) {
  Scene scene;
  const auto anchored = anchoredPoints(graph);
  const auto placeOf = [&](const VertexType& type, const Vertex& vertex) -> std::optional<Place> {
    if (const auto found = anchored.find(vertex.id()); found != anchored.end()) {
      const std::optional<Vector<double, 3>>& p = found->second;
      return p ? std::optional(Place{isometric((*p)[0], (*p)[1], (*p)[2]), false}) : std::nullopt;
    }
    return type.placeKind() != PlaceKind::none ? std::optional(ownPlace(type, vertex)) : std::nullopt;
  };
  Places places;
  graph.forEachVertex([&](const Vertex& vertex) {
    const VertexType& type = graph.typeOf(vertex);
    if (!vertex.hasEstimate()) {
      ++scene.withoutEstimate;
      return;
    }
    const std::optional<Place> place = placeOf(type, vertex);
    if (!place || !std::isfinite(place->point.x) || !std::isfinite(place->point.y)) {
      ++scene.withoutPlace;
      return;
    }
    places.emplace(vertex.id(), *place);
    (place->pose ? scene.poses : scene.landmarks).push_back(place->point);
    scene.spatial = scene.spatial || (type.placeKind() != PlaceKind::none && !isPlanar(type.placeKind()));
  });
  if (places.empty()) {
    throw GraphError(
        fmt::format("nothing to draw: of {}, {} without estimate, and {} of types that are neither poses nor points",
                    counted(graph.vertexCount(), "vertex", "vertices"), scene.withoutEstimate, scene.withoutPlace));
  }
  addEdges(graph, places, scene);
  return scene;
}

}  // namespace quiver::app
