#include <memory>
#include <random>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/core/registry/registry.h>
#include <quiver/types_slam3d/edge_se3.h>
#include <quiver/types_slam3d/edge_se3_log.h>
#include <quiver/types_slam3d/edge_se3_prior.h>
#include <quiver/types_slam3d/edge_se3_xyz.h>
#include <quiver/types_slam3d/register.h>

namespace quiver {
namespace {

/// Deviation that differences with a step of 1e-5 leave.
constexpr double jacobianTolerance = 1e-7;

class EdgeSE3Test : public ::testing::Test {
 protected:
  EdgeSE3Test() : registry_(std::make_shared<Registry>()) { registerSlam3d(*registry_); }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  SE3<double> pose(double angle = 2.0) {
    Vector<double, 6> tangent;
    for (int i = 0; i < 3; ++i) tangent[i] = uniform(-3.0, 3.0);
    for (int i = 3; i < 6; ++i) tangent[i] = uniform(-1.0, 1.0);
    tangent.tail<3>() *= angle / tangent.tail<3>().norm();
    return SE3<double>::exp(tangent);
  }

  std::shared_ptr<Registry> registry_;
  std::mt19937 random_{1};
};

TEST_F(EdgeSE3Test, JacobiansAtAnyResidualRotation) {
  Graph graph(registry_);
  graph.addParameter<ParameterSE3Offset>(0, pose());
  std::int64_t id = 0;
  for (const double angle : {0.0, 1e-9, 1e-3, 0.5, 1.5, 3.0, 3.1415, -3.1415}) {
    const SE3<double> from = pose(), to = pose();
    const SE3<double> z = from.between(to) * pose(angle).inverse();
    graph.addVertex<VertexSE3>(id, from);
    graph.addVertex<VertexSE3>(id + 1, to);
    graph.addEdge<EdgeSE3>({id, id + 1}, z, Matrix<double, 6, 6>::Identity());
    graph.addEdge<EdgeSE3Log>({id, id + 1}, z, Matrix<double, 6, 6>::Identity());
    graph.addEdge<EdgeSE3Prior>({id}, from * pose(angle), Matrix<double, 6, 6>::Identity(), {0});
    id += 2;
  }
  const JacobianReport report = checkJacobians(graph);
  EXPECT_EQ(report.types.size(), 3u);
  EXPECT_LT(report.worstDeviation(), jacobianTolerance) << report.describe();
}

TEST_F(EdgeSE3Test, ApproximationIsRightToFirstOrder) {
  for (const double size : {1e-2, 1e-3}) {
    Graph graph(registry_);
    const SE3<double> from = pose(), to = pose();
    Vector<double, 6> small = pose().log().normalized() * size;
    graph.addVertex<VertexSE3>(0, from);
    graph.addVertex<VertexSE3>(1, to);
    graph.addEdge<EdgeSE3LogApproximate>({0, 1}, from.between(to) * SE3<double>::exp(small),
                                         Matrix<double, 6, 6>::Identity());
    const double deviation = checkJacobians(graph).worstDeviation();
    EXPECT_LT(deviation, 10.0 * size * size);
    EXPECT_GT(deviation, 1e-3 * size * size);
  }
}

TEST_F(EdgeSE3Test, PointSeenBySensor) {
  Graph graph(registry_);
  graph.addParameter<ParameterSE3Offset>(7, pose());
  for (std::int64_t i = 0; i < 8; ++i) {
    graph.addVertex<VertexSE3>(i, pose());
    graph.addVertex<VertexXYZ>(100 + i, Vector<double, 3>(uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)));
    graph.addEdge<EdgeSE3XYZ>({i, 100 + i}, Vector<double, 3>(1.0, 2.0, 3.0), Matrix<double, 3, 3>::Identity(), {7});
  }
  const JacobianReport report = checkJacobians(graph);
  EXPECT_LT(report.worstDeviation(), jacobianTolerance) << report.describe();
}

TEST_F(EdgeSE3Test, ErrorIsTheQuaternionsVectorPart) {
  const SE3<double> x = pose(), y = pose();
  EXPECT_LT((EdgeSE3::computeError<double>(x.between(y), x, y)).norm(), 1e-15);
  // A quarter turn about z and a metre along x; the sign of the quaternion does not matter.
  const double s = std::sqrt(0.5);
  const SE3<double> turn(1.0, 0.0, 0.0, 0.0, 0.0, -s, -s);
  const Vector<double, 6> error = EdgeSE3::computeError<double>(SE3<double>(), SE3<double>(), turn);
  Vector<double, 6> expected;
  expected << 1.0, 0.0, 0.0, 0.0, 0.0, s;
  EXPECT_LT((error - expected).norm(), 1e-15);
}

}  // namespace
}  // namespace quiver
