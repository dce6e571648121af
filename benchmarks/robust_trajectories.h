#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include <quiver/quiver.h>
#include <Eigen/Geometry>

namespace quiver {

/// Positions of a pose graph's vertices, two or three rows, one column a vertex in the order of ids. Empty if it has no
/// poses.
inline Eigen::MatrixXd positionsOf(const Graph& graph) {
  std::map<std::int64_t, Eigen::VectorXd> places;
  graph.forEachVertex([&](const Vertex& vertex) {
    const std::string& tag = graph.typeOf(vertex).tag();
    if (tag == "VERTEX_SE2") {
      places[vertex.id()] = static_cast<const VertexSE2&>(vertex).estimate().translation();
    } else if (tag == "VERTEX_SE3:QUAT") {
      places[vertex.id()] = static_cast<const VertexSE3&>(vertex).estimate().translation();
    }
  });
  if (places.empty()) return {};
  Eigen::MatrixXd positions(places.begin()->second.size(), static_cast<Eigen::Index>(places.size()));
  Eigen::Index column = 0;
  for (const auto& [id, place] : places) positions.col(column++) = place;
  return positions;
}

/// The absolute trajectory error: the root of the mean squared distance in metres after the best rigid motion of
/// `estimate` onto `truth` (Umeyama's, without scale).
inline double trajectoryError(const Eigen::MatrixXd& estimate, const Eigen::MatrixXd& truth) {
  const Eigen::MatrixXd motion = Eigen::umeyama(estimate, truth, false);
  const Eigen::Index d = estimate.rows();
  const Eigen::MatrixXd moved = (motion.topLeftCorner(d, d) * estimate).colwise() + motion.col(d).head(d);
  return std::sqrt((moved - truth).squaredNorm() / static_cast<double>(truth.cols()));
}

/// The true positions of a world of streets a metre apart with square corners, as M3500's: odometry rounded to whole
/// metres and quarter turns is exact. `worst` receives how far any measurement, loop closures included, is from the
/// truth, in metres or radians; that it is small proves the rounding right.
inline Eigen::MatrixXd latticeTruth(const Graph& graph, double& worst) {
  std::map<std::int64_t, const EdgeSE2*> odometry;
  std::vector<const EdgeSE2*> all;
  graph.forEachEdge([&](const Edge& edge) {
    if (graph.typeOf(edge).tag() != "EDGE_SE2") return;
    all.push_back(static_cast<const EdgeSE2*>(&edge));
    if (edge.vertexId(1) == edge.vertexId(0) + 1) odometry[edge.vertexId(0)] = all.back();
  });
  const double quarter = 0.5 * std::numbers::pi;
  std::map<std::int64_t, SE2<double>> truth{{odometry.begin()->first, SE2<double>()}};
  for (const auto& [id, edge] : odometry) {
    const SE2<double> z = edge->measurement();
    const SE2<double> step(std::round(z.x()), std::round(z.y()), quarter * std::round(z.angle() / quarter));
    truth[id + 1] = truth.at(id) * step;
  }
  worst = 0.0;
  for (const EdgeSE2* edge : all) {
    const SE2<double> off =
        edge->measurement().between(truth.at(edge->vertexId(0)).between(truth.at(edge->vertexId(1))));
    worst = std::max(worst, off.toVector().cwiseAbs().maxCoeff());
  }
  Eigen::MatrixXd positions(2, static_cast<Eigen::Index>(truth.size()));
  Eigen::Index column = 0;
  for (const auto& [id, pose] : truth) positions.col(column++) = pose.translation();
  return positions;
}

/// The root mean squared distance of points in space from the sphere that fits them best: no trajectory on that sphere
/// is nearer to them.
inline double distanceFromSphere(const Eigen::MatrixXd& points) {
  Eigen::MatrixXd A(points.cols(), 4);
  A << 2.0 * points.transpose(), Eigen::VectorXd::Ones(points.cols());
  const Eigen::Vector4d fit =
      (A.transpose() * A).ldlt().solve(A.transpose() * points.colwise().squaredNorm().transpose());
  const double radius = std::sqrt(fit[3] + fit.head<3>().squaredNorm());
  const Eigen::VectorXd distances = (points.colwise() - fit.head<3>()).colwise().norm();
  return std::sqrt((distances.array() - radius).square().mean());
}

}  // namespace quiver
