#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "ring_graph.h"

namespace quiver::test {

/// Descents as a textbook writes them: errors of the ring graph by hand, differences for
/// Jacobians, one dense matrix, pose 0 held. Independent of batches, assembly, ordering and factorisation.
class DenseTwin {
 public:
  explicit DenseTwin(const Graph& graph, int poses, int points) : graph_(graph), poses_(poses), points_(points) {}

  double chi2() const { return residuals(graph_).squaredNorm(); }
  /// chi2 of the estimates moved by δ, which stay as they are.
  double chi2At(const Eigen::VectorXd& delta) const { return residuals(moved(delta)).squaredNorm(); }
  void move(const Eigen::VectorXd& delta) { graph_ = moved(delta); }

  /// H = JᵀJ and g = Jᵀr; rows and columns of the held pose are those of the identity, and zero in g.
  struct System {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
  };
  System linearize() const {
    const Eigen::VectorXd r = residuals(graph_);
    Eigen::MatrixXd J(r.size(), 3 * poses_ + 2 * points_);
    constexpr double h = 1e-6;
    for (int c = 0; c < J.cols(); ++c) {
      Eigen::VectorXd delta = Eigen::VectorXd::Zero(J.cols());
      delta[c] = h;
      const Eigen::VectorXd forward = residuals(moved(delta));
      delta[c] = -h;
      J.col(c) = (forward - residuals(moved(delta))) / (2.0 * h);
    }
    J.leftCols(3).setZero();
    System system{J.transpose() * J, J.transpose() * r};
    system.H.topLeftCorner(3, 3).setIdentity();
    return system;
  }

  /// One step with (H + λ diag H) δ = −g; returns chi2 after it.
  double step(double lambda) {
    System system = linearize();
    system.H.diagonal() += lambda * system.H.diagonal();
    move(system.H.ldlt().solve(-system.g));
    return chi2();
  }

 private:
  Graph moved(const Eigen::VectorXd& delta) const {
    Graph result(graph_);
    for (int i = 0; i < poses_; ++i) {
      auto& pose = result.vertex<VertexSE2>(i);
      const SE2<double> x = pose.estimate();
      const double c = std::cos(x.angle());
      const double s = std::sin(x.angle());
      const Eigen::Vector3d d = delta.segment<3>(3 * i);
      pose.setEstimate(SE2<double>(x.x() + c * d[0] - s * d[1], x.y() + s * d[0] + c * d[1], x.angle() + d[2]));
    }
    for (int p = 0; p < points_; ++p) {
      auto& point = result.vertex<VertexPoint>(1000 + p);
      point.setEstimate(point.estimate() + Vector<double, 2>(delta.segment<2>(3 * poses_ + 2 * p)));
    }
    return result;
  }

  static Eigen::VectorXd residuals(const Graph& graph) {
    std::vector<double> all;
    graph.forEachEdge([&](const Edge& edge) {
      const SE2<double> a = graph.vertex<VertexSE2>(edge.vertexId(0)).estimate();
      if (edge.vertexId(1) >= 1000) {
        const auto& range = static_cast<const EdgeRangeAnalytic&>(edge);
        const Vector<double, 2> b = graph.vertex<VertexPoint>(edge.vertexId(1)).estimate();
        all.push_back(20.0 * (std::hypot(b[0] - a.x(), b[1] - a.y()) - range.measurement()));
        return;
      }
      const SE2<double> b = graph.vertex<VertexSE2>(edge.vertexId(1)).estimate();
      const SE2<double> z = static_cast<const EdgeSE2&>(edge).measurement();
      const Eigen::Rotation2Dd toA(-a.angle());
      const Eigen::Vector2d relative = toA * Eigen::Vector2d(b.x() - a.x(), b.y() - a.y());
      const Eigen::Vector2d t = Eigen::Rotation2Dd(-z.angle()) * (relative - Eigen::Vector2d(z.x(), z.y()));
      const double turn = b.angle() - a.angle() - z.angle();
      all.insert(all.end(), {50.0 * t[0], 50.0 * t[1], 100.0 * std::remainder(turn, 2.0 * std::numbers::pi)});
    });
    return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }

  Graph graph_;
  int poses_;
  int points_;
};

}  // namespace quiver::test
