#include <quiver/types_slam3d/measured_points.h>

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/estimates.h>
#include <quiver/types_slam3d/edge_se3_projection.h>
#include <quiver/types_slam3d/edge_se3_xyz.h>

namespace quiver {
namespace {

using Matrix3 = Matrix<double, 3, 3>;
using Vector3 = Vector<double, 3>;

/// A point in the camera and its information.
struct MeasuredPoint {
  Vector3 point;
  Matrix3 information;
};

/// From (u, v, w) with its information Ω, w the depth or its inverse. The point weighs in all directions what it weighs
/// in the worst, the least eigenvalue of Nᵀ Ω N, N = ∂(u, v, w)/∂p: that pixels know directions a thousand times better
/// than odometry does is what makes poor estimates fold up.
MeasuredPoint measuredPoint(const Vector3& z, const Matrix3& information, const Vector<double, 11>& camera,
                            bool inverse) {
  const double depth = inverse ? 1.0 / z[2] : z[2];
  const double fx = camera[7], fy = camera[8];
  const Vector3 p((z[0] - camera[9]) / fx * depth, (z[1] - camera[10]) / fy * depth, depth);
  Matrix3 N;
  N << fx / depth, 0.0, -fx * p[0] / (depth * depth),  //
      0.0, fy / depth, -fy * p[1] / (depth * depth),   //
      0.0, 0.0, inverse ? -1.0 / (depth * depth) : 1.0;
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(Matrix3(N.transpose() * information * N), Eigen::EigenvaluesOnly);
  return {p, std::max(0.0, eigen.eigenvalues()[0]) * Matrix3::Identity()};
}

/// Where cameras are in the body, as parameters of edges that measure points.
class Offsets {
 public:
  explicit Offsets(Graph& graph) : graph_(graph) {}
  std::int64_t of(std::int64_t camera, const Vector<double, 11>& numbers) {
    const auto [place, isNew] = known_.try_emplace(camera, 0);
    if (!isNew) return place->second;
    while (graph_.findParameter(next_) != nullptr) ++next_;
    graph_.addParameter<ParameterSE3Offset>(next_, detail::cameraPose(numbers));
    return place->second = next_;
  }

 private:
  Graph& graph_;
  std::map<std::int64_t, std::int64_t> known_;
  std::int64_t next_ = 0;
};

/// Replaces the edges of one type in a copy of a graph; the number of them.
template <typename E>
std::int64_t replaceEdges(Graph& graph, Offsets& offsets, bool inverse) {
  const EdgeType* const type = graph.registry()->findEdgeTypeByName(typeName<E>());
  if (type == nullptr) return 0;
  std::vector<E*> edges;
  graph.forEachEdge([&](Edge& edge) {
    if (&graph.typeOf(edge) == type) edges.push_back(static_cast<E*>(&edge));
  });
  for (E* const edge : edges) {
    const std::int64_t camera = edge->parameterIds().front();
    const Vector<double, 11> numbers =
        static_cast<const ParameterCamera*>(std::as_const(graph).findParameter(camera))->value();
    const Vector3 z = edge->measurement();
    if (z[2] > 0.0) {
      const MeasuredPoint measured = measuredPoint(z, edge->information(), numbers, inverse);
      auto& point = graph.addEdge<EdgeSE3XYZ>({edge->vertexId(0), edge->vertexId(1)}, measured.point,
                                              measured.information, {offsets.of(camera, numbers)});
      point.setRobustKernel(edge->robustKernel());
      point.setLevel(edge->level());
    }
    graph.removeEdge(*edge);
  }
  return static_cast<std::int64_t>(edges.size());
}

}  // namespace

std::string measuredPointsEstimate(Graph& graph, const Options& options) {
  const Registry& registry = *graph.registry();
  Graph copy(graph);
  if (registry.findEdgeTypeByName(typeName<EdgeSE3XYZ>()) == nullptr)
    throw GraphError("initial guess from measured points: the registry has no EDGE_SE3_TRACKXYZ");
  Offsets offsets(copy);
  const std::int64_t count =
      replaceEdges<EdgeSE3Depth>(copy, offsets, false) + replaceEdges<EdgeSE3Disparity>(copy, offsets, true);
  if (count == 0) throw GraphError("initial guess from measured points: no edge sees a pixel and a depth or disparity");
  Options quiet = options;
  quiet.callback = {};
  quiet.phase = {};
  quiet.algorithm = "auto";
  const Summary summary = optimize(copy, quiet);
  copyEstimates(copy, graph);
  const std::size_t steps = summary.iterations.size();
  return fmt::format("{}, {} step{}",
                     count == 1 ? "1 pixel with a depth taken for a point"
                                : fmt::format("{} pixels with depths taken for points", count),
                     steps, steps == 1 ? "" : "s");
}

}  // namespace quiver
