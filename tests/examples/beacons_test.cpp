#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "examples/plaza.h"

namespace quiver {
namespace {

using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;

/// x, y, θ of a pose or x, y of a beacon.
Eigen::VectorXd valuesOf(const Graph& graph, std::int64_t id) {
  if (id < 1000) return graph.vertex<VertexSE2>(id).estimate().toVector();
  return graph.vertex<plaza::VertexBeacon>(id).estimate();
}

/// Whitened error of an edge at given values, written out by hand.
Eigen::VectorXd errorAt(const Edge& edge, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (edge.vertexId(1) >= 1000) {
    const auto& range = static_cast<const plaza::EdgeRange&>(edge);
    const double error = std::hypot(b[0] - a[0], b[1] - a[1]) - range.measurement();
    return Eigen::VectorXd::Constant(1, std::sqrt(range.information()(0, 0)) * error);
  }
  const auto& odometry = static_cast<const EdgeSE2&>(edge);
  const SE2<double> z = odometry.measurement();
  const double heading = a[2] + z.angle();
  const double dx = b[0] - a[0] - std::cos(a[2]) * z.x() + std::sin(a[2]) * z.y();
  const double dy = b[1] - a[1] - std::sin(a[2]) * z.x() - std::cos(a[2]) * z.y();
  Eigen::Vector3d error(std::cos(heading) * dx + std::sin(heading) * dy,
                        -std::sin(heading) * dx + std::cos(heading) * dy,
                        std::remainder(b[2] - heading, 2.0 * std::numbers::pi));
  return odometry.information().diagonal().cwiseSqrt().cwiseProduct(error);
}

/// H⁻¹ over all vertices but the fixed pose, dense, Jacobians by differences; `offsets` tells where a vertex begins.
Eigen::MatrixXd covariance(const Graph& graph, std::map<std::int64_t, int>& offsets) {
  int size = 0;
  graph.forEachVertex([&](const Vertex& vertex) {
    if (vertex.fixed()) return;
    offsets[vertex.id()] = size;
    size += vertex.id() < 1000 ? 3 : 2;
  });
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  graph.forEachEdge([&](const Edge& edge) {
    std::vector<Eigen::VectorXd> x{valuesOf(graph, edge.vertexId(0)), valuesOf(graph, edge.vertexId(1))};
    std::vector<Jacobian> J(2);
    constexpr double h = 1e-6;
    for (std::size_t role = 0; role < 2; ++role) {
      const Eigen::VectorXd center = x[role];
      J[role].resize(errorAt(edge, x[0], x[1]).size(), center.size());
      for (int c = 0; c < center.size(); ++c) {
        x[role][c] = center[c] + h;
        const Eigen::VectorXd forward = errorAt(edge, x[0], x[1]);
        x[role][c] = center[c] - h;
        J[role].col(c) = (forward - errorAt(edge, x[0], x[1])) / (2.0 * h);
        x[role] = center;
      }
    }
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        const auto row = offsets.find(edge.vertexId(a));
        const auto column = offsets.find(edge.vertexId(b));
        if (row == offsets.end() || column == offsets.end()) continue;
        const Jacobian& left = J[static_cast<std::size_t>(a)];
        const Jacobian& right = J[static_cast<std::size_t>(b)];
        H.block(row->second, column->second, left.cols(), right.cols()) += left.transpose() * right;
      }
    }
  });
  return H.llt().solve(Eigen::MatrixXd::Identity(size, size));
}

/// On a graph that simulate_plaza writes: the file loses nothing, the minimum is as deep as the noise says.
TEST(Beacons, FileAndMinimumAreRight) {
  auto simulated = plaza::Simulation(1).run();
  const std::string file = ::testing::TempDir() + "quiver_plaza.g2o";
  writeGraph(file, simulated.graph);
  Graph graph = readGraph(file, plaza::makeRegistry());
  std::filesystem::remove(file);
  const Summary summary = optimize(graph, {.maxIterations = 30});
  ASSERT_EQ(summary.status, Status::converged) << summary.reason;
  // A file keeps angles, not the sines that dead reckoning multiplied: the same to rounding.
  EXPECT_NEAR(optimize(simulated.graph, {.maxIterations = 30}).finalChi2, summary.finalChi2, 1e-9 * summary.finalChi2);
  // As many degrees of freedom as residuals less unknowns; five standard deviations of χ².
  const double freedom = 3.0 * 160 + (graph.edgeCount() - 160) - (3.0 * 160 + 2.0 * 5);
  EXPECT_NEAR(summary.finalChi2, freedom, 5.0 * std::sqrt(2.0 * freedom));
}

/// |error| / σ of the worst coordinate of any beacon, σ from the covariance linearised at the minimum.
double worstInSigmas(const plaza::Simulation::Result& simulated) {
  std::map<std::int64_t, int> offsets;
  const Eigen::MatrixXd P = covariance(simulated.graph, offsets);
  double worst = 0.0;
  for (const auto& [id, place] : simulated.beacons) {
    const Eigen::VectorXd found = valuesOf(simulated.graph, id);
    for (int c = 0; c < 2; ++c) {
      const int at = offsets.at(id) + c;
      const double sigma = std::sqrt(P(at, at));
      // The frame hangs on the odometry of the first metres: 0.02 rad over the 33 m to the farthest beacon.
      EXPECT_LT(sigma, 0.02 * 33.0) << "metres";
      worst = std::max(worst, std::abs(found[c] - place[c]) / sigma);
    }
  }
  return worst;
}

/// How much deeper the minimum is than the one with all beacons at their true places: χ² of ten degrees of freedom if
/// the estimator is right, and, unlike σ, exact where the likelihood is curved.
double likelihoodRatio(plaza::Simulation::Result& simulated, double minimum) {
  for (const auto& [id, place] : simulated.beacons) {
    auto& beacon = simulated.graph.vertex<plaza::VertexBeacon>(id);
    beacon.setEstimate(place);
    beacon.setFixed(true);
  }
  return optimize(simulated.graph, {.maxIterations = 30}).finalChi2 - minimum;
}

/// All beacons lie within three σ of the truth. By chance alone that fails in about one world of a hundred; of the
/// twenty here it does in one (seed 2), where the likelihood ratio shows the deviation to be an ordinary one.
TEST(Beacons, AreFoundWithinThreeSigma) {
  int beyond = 0;
  double sum = 0.0;
  constexpr int worlds = 20;
  for (std::uint32_t seed = 1; seed <= worlds; ++seed) {
    auto simulated = plaza::Simulation(seed).run();
    const Summary summary = optimize(simulated.graph, {.maxIterations = 30});
    ASSERT_EQ(summary.status, Status::converged) << summary.reason;
    beyond += worstInSigmas(simulated) > 3.0;
    const double ratio = likelihoodRatio(simulated, summary.finalChi2);
    EXPECT_LT(ratio, 29.59) << "0.999 quantile, seed " << seed;
    sum += ratio;
  }
  EXPECT_LE(beyond, 1);
  // The mean of twenty is 10 ± 1.
  EXPECT_NEAR(sum / worlds, 10.0, 3.0);
}

}  // namespace
}  // namespace quiver
