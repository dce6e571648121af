#include <quiver/core/algorithm/descent.h>

#include <cmath>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

/// Gauss–Newton and Levenberg–Marquardt as a textbook writes them: errors of the ring graph by hand, differences for
/// Jacobians, one dense matrix, pose 0 held. Independent of batches, assembly, ordering and factorisation.
class DenseTwin {
 public:
  explicit DenseTwin(const Graph& graph, int poses, int points) : graph_(graph), poses_(poses), points_(points) {}

  double chi2() const { return residuals(graph_).squaredNorm(); }

  /// One step with (H + λ diag H) δ = −g; returns chi2 after it.
  double step(double lambda) {
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
    Eigen::MatrixXd H = J.transpose() * J;
    H.diagonal() += lambda * H.diagonal();
    H.topLeftCorner(3, 3).setIdentity();
    graph_ = moved(H.ldlt().solve(-J.transpose() * r));
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

/// The twin's differences err by 1e-9 of the step; chi2 after a step that far from the optimum moves by as much.
constexpr double traceTolerance = 1e-6;

TEST(Descent, FollowsADenseTwin) {
  Graph graph = ringGraph<EdgeRangeAnalytic>(15, 4);
  graph.vertex<VertexSE2>(0).setFixed(true);
  DenseTwin twin(graph, 15, 4);
  const Summary summary = optimize(graph, {.maxIterations = 4, .algorithm = "gn"});
  EXPECT_NEAR(summary.initialChi2, twin.chi2(), 1e-10 * summary.initialChi2);
  ASSERT_EQ(summary.iterations.size(), 4U);
  for (const IterationReport& report : summary.iterations)
    EXPECT_NEAR(report.chi2, twin.step(0.0), traceTolerance * report.chi2) << report.iteration;
}

TEST(Descent, ADampedStepIsTheDenseTwins) {
  for (const double damping : {1e-4, 0.1, 3.0}) {
    Graph graph = ringGraph<EdgeRangeAnalytic>(15, 4);
    graph.vertex<VertexSE2>(0).setFixed(true);
    DenseTwin twin(graph, 15, 4);
    const Summary summary = optimize(graph, {.maxIterations = 1, .algorithm = "lm", .initialDamping = damping});
    ASSERT_TRUE(summary.iterations.at(0).accepted);
    EXPECT_NEAR(summary.finalChi2, twin.step(damping), traceTolerance * summary.finalChi2) << damping;
  }
}

TEST(Descent, AllSolversAndAlgorithmsMeetAtOneOptimum) {
  Graph reference = ringGraph<EdgeRangeDual>(30, 6);
  const double best = optimize(reference).finalChi2;
  for (const char* solver : {"auto", "block", "dense", "eigen"}) {
    for (const char* algorithm : {"gn", "lm"}) {
      Graph graph = ringGraph<EdgeRangeDual>(30, 6);
      const Summary summary = optimize(graph, {.algorithm = algorithm, .linearSolver = solver});
      EXPECT_EQ(summary.status, Status::converged) << summary.reason;
      EXPECT_NEAR(summary.finalChi2, best, 1e-8 * best) << solver << " " << algorithm;
    }
  }
}

TEST(Descent, NeverEndsAboveTheLowestCostMet) {
  Graph graph = ringGraph<EdgeRangeDual>(30, 6);
  for (int id = 0; id < 30; id += 2) graph.vertex<VertexSE2>(id).setEstimate(SE2<double>(-20.0 * id, 3.0, 2.5));
  for (const char* algorithm : {"auto", "gn", "lm"}) {
    for (const int limit : {1, 2, 3, 5, 20}) {
      Graph copy(graph);
      const Summary summary = optimize(copy, {.maxIterations = limit, .algorithm = algorithm});
      double lowest = summary.initialCost;
      for (const IterationReport& report : summary.iterations) lowest = std::min(lowest, report.cost);
      EXPECT_LE(summary.finalCost, lowest * (1.0 + 1e-12)) << algorithm << " " << limit;
    }
  }
}

}  // namespace
}  // namespace quiver
