#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>

#include "dense_twin.h"

namespace quiver {
namespace {

using namespace test;

/// Powell's dogleg with dense matrices; the point of the path at a radius by bisection.
class DoglegTwin {
 public:
  explicit DoglegTwin(DenseTwin world)
      : world_(std::move(world)), scale_(Eigen::VectorXd::Zero(world_.linearize().g.size())) {
    linearize();
  }

  /// One trial; whether it is accepted.
  bool step() {
    const Eigen::VectorXd delta = pointAt(radius_);
    const double predicted = -2.0 * system_.g.dot(delta) - delta.dot(system_.H * delta);
    const double ratio = (world_.chi2() - world_.chi2At(delta)) / predicted;
    const double length = norm(delta);
    if (ratio > 0.75) radius_ = std::max(radius_, 3.0 * length);
    if (ratio < 0.25) radius_ = 0.5 * std::min(radius_, length);
    if (!(ratio > 1e-3)) return false;
    world_.move(delta);
    memory_ = ratio < 0.25 ? 1.0 : 0.5;
    linearize();
    return true;
  }
  double chi2() const { return world_.chi2(); }

 private:
  void linearize() {
    system_ = world_.linearize();
    scale_ = (memory_ * scale_).cwiseMax(system_.H.diagonal());
    full_ = system_.H.ldlt().solve(-system_.g);
    const Eigen::VectorXd down = -system_.g.cwiseQuotient(scale_);
    cauchy_ = down * (-down.dot(system_.g) / down.dot(system_.H * down));
  }
  double norm(const Eigen::VectorXd& delta) const { return std::sqrt(delta.dot(scale_.cwiseProduct(delta))); }
  Eigen::VectorXd path(double t) const {
    return std::min(t, 1.0) * cauchy_ + std::max(t - 1.0, 0.0) * (full_ - cauchy_);
  }
  Eigen::VectorXd pointAt(double radius) const {
    if (norm(full_) <= radius) return full_;
    double low = 0.0;
    double high = 2.0;
    for (int i = 0; i < 100; ++i) (norm(path(0.5 * (low + high))) < radius ? low : high) = 0.5 * (low + high);
    return path(low);
  }

  DenseTwin world_;
  DenseTwin::System system_;
  Eigen::VectorXd scale_, full_, cauchy_;
  double memory_ = 0.0;
  double radius_ = std::numeric_limits<double>::infinity();
};

/// A ring whose poses are so far off that full steps fail.
Graph scatteredRing(double turn, double spread) {
  Graph graph = ringGraph<EdgeRangeAnalytic>(15, 4);
  graph.vertex<VertexSE2>(0).setFixed(true);
  for (int id = 1; id < 15; ++id) {
    auto& pose = graph.vertex<VertexSE2>(id);
    const SE2<double> x = pose.estimate();
    pose.setEstimate(SE2<double>(x.x() + spread * std::sin(5.0 * id), x.y() - spread * std::cos(3.0 * id),
                                 x.angle() + turn * std::sin(2.0 * id)));
  }
  return graph;
}

TEST(Dogleg, FollowsADenseTwinThroughRejections) {
  int rejections = 0;
  for (const double turn : {1.2, 2.0, 3.0}) {
    Graph graph = scatteredRing(turn, 12.0);
    DoglegTwin twin(DenseTwin(graph, 15, 4));
    const Summary summary = optimize(graph, {.maxIterations = 8, .algorithm = "dogleg"});
    ASSERT_GE(summary.iterations.size(), 5U);
    for (const IterationReport& report : summary.iterations) {
      const bool accepted = twin.step();
      EXPECT_EQ(report.accepted, accepted) << turn << " " << report.iteration;
      // The twin's differences err by 1e-9 of a step, and steps far from the optimum amplify it.
      EXPECT_NEAR(report.chi2, twin.chi2(), 1e-5 * report.chi2) << turn << " " << report.iteration;
      rejections += accepted ? 0 : 1;
    }
  }
  EXPECT_GT(rejections, 0) << "the case must exercise the radius";
}

TEST(Dogleg, ARejectionCostsNoFactorization) {
  int free = 0;
  for (const double turn : {1.2, 2.0, 3.0}) {
    Graph graph = scatteredRing(turn, 12.0);
    const Summary summary = optimize(graph, {.algorithm = "dogleg"});
    bool rejectedBefore = false;
    for (const IterationReport& report : summary.iterations) {
      EXPECT_EQ(report.seconds.factorize == 0.0, rejectedBefore) << turn << " " << report.iteration;
      free += rejectedBefore ? 1 : 0;
      rejectedBefore = !report.accepted;
    }
  }
  EXPECT_GT(free, 0) << "the case must exercise the radius";
}

TEST(Dogleg, DescendsWhereTheGaugeIsFree) {
  Graph graph = ringGraph<EdgeRangeDual>(30, 6);
  Graph reference = ringGraph<EdgeRangeDual>(30, 6);
  const double best = optimize(reference).finalChi2;
  const Summary summary = optimize(graph, {.algorithm = "dogleg", .gauge = GaugePolicy::free});
  EXPECT_TRUE(summary.converged()) << summary.reason;
  EXPECT_EQ(summary.gauge.free, 3);
  EXPECT_NEAR(summary.finalChi2, best, 1e-8 * best);
}

TEST(Dogleg, NamesAWrongJacobian) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.0, 2.0));
  graph.addEdge<EdgeWrong>({0}, Vector<double, 2>(0.0, 0.0), weight2());
  const Summary summary = optimize(graph, {.maxIterations = 200, .algorithm = "dogleg"});
  EXPECT_EQ(summary.status, Status::stalled);
  EXPECT_NE(summary.reason.find("Jacobian"), std::string::npos) << summary.reason;
}

}  // namespace
}  // namespace quiver
