// What chordal initialisation makes of vertices that are no poses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/stop_condition.h>
#include <quiver/initialization/chordal.h>
#include <quiver/quiver.h>
#include <quiver/types_sba/models/edge_project.h>
#include <quiver/types_slam2d/edge_xy.h>
#include <quiver/types_slam3d/edge_se3.h>

namespace quiver {
namespace {

constexpr std::int64_t camera = 900;

/// Cameras along a line, chained, that see points ahead with intrinsics which are a vertex of their own.
Graph camerasInARow(bool intrinsicsKnown) {
  Graph graph(builtinRegistry());
  const Vector<double, 4> intrinsics(500.0, 500.0, 320.0, 240.0);
  const auto poseOf = [](int i) { return SE3<double>(SO3<double>::exp({0.0, 0.02 * i, 0.0}), {0.5 * i, 0.0, 0.0}); };
  if (intrinsicsKnown) {
    graph.addVertex<VertexPinhole>(camera, intrinsics);
  } else {
    graph.addVertex<VertexPinhole>(camera);
  }
  for (int i = 0; i < 6; ++i) {
    graph.addVertex<VertexSE3>(i, SE3<double>());
    if (i > 0) graph.addEdge<EdgeSE3>({i - 1, i}, poseOf(i - 1).between(poseOf(i)), Matrix<double, 6, 6>::Identity());
  }
  for (int p = 0; p < 12; ++p) {
    const Vector<double, 3> at(0.3 * p - 0.5, 0.4 * (p % 3) - 0.4, 5.0 + 0.1 * p);
    graph.addVertex<VertexXYZ>(100 + p, at);
    for (int i = 0; i < 6; ++i) {
      const Vector<double, 2> pixel = CameraPinhole::project<double>(intrinsics, poseOf(i).actInverse(at));
      graph.addEdge<EdgeProjectPinholeIntrinsics>({i, 100 + p, camera}, pixel, Matrix<double, 2, 2>::Identity());
    }
  }
  return graph;
}

TEST(ChordalLandmarks, KeepWhatNoEdgeTells) {
  Graph graph = camerasInARow(true);
  EXPECT_EQ(chordalEstimate(graph, {}), "chordal relaxation of 6 poses");
  EXPECT_EQ(graph.vertex<VertexPinhole>(camera).estimate(), (Vector<double, 4>(500.0, 500.0, 320.0, 240.0)));
  for (int p = 0; p < 12; ++p) EXPECT_TRUE(graph.findVertex(100 + p)->hasEstimate());
  EXPECT_NEAR(graph.vertex<VertexSE3>(5).estimate().translation()[0], 2.5, 1e-6);
}

TEST(ChordalLandmarks, NameWhatHasNoEstimateAtAll) {
  Graph graph = camerasInARow(false);
  try {
    (void)chordalEstimate(graph, {});
    ADD_FAILURE() << "nothing can tell the intrinsics";
  } catch (const GraphError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("vertex 900 (VERTEX_PINHOLE) is, and it has no estimate"));
  }
}

/// A chain of points known at its last one: each turn over the edges would tell one point alone.
Graph pointsInARow(int points) {
  Graph graph(builtinRegistry());
  graph.addVertex<VertexSE2>(0, SE2<double>());
  graph.addVertex<VertexSE2>(1, SE2<double>(1.0, 0.0, 0.0));
  graph.addEdge<EdgeSE2>({0, 1}, SE2<double>(1.0, 0.0, 0.0), Matrix<double, 3, 3>::Identity());
  for (int p = 0; p < points; ++p) graph.addVertex<VertexXY>(10 + p, Vector<double, 2>(0.0, 0.0));
  for (int p = 0; p + 1 < points; ++p)
    graph.addEdge<EdgeXY>({10 + p, 11 + p}, Vector<double, 2>(1.0, 0.5), Matrix<double, 2, 2>::Identity());
  graph.addEdge<EdgeSE2XY>({0, 10 + points - 1}, Vector<double, 2>(points - 1.0, 0.5 * (points - 1.0)),
                           Matrix<double, 2, 2>::Identity());
  return graph;
}

TEST(ChordalLandmarks, StayWhereTheyAreHeldByTheFreeSubset) {
  Graph graph = pointsInARow(4);
  for (const std::int64_t id : {10, 11}) graph.vertex<VertexXY>(id).setEstimate(Vector<double, 2>(7.0, 7.0));
  (void)chordalEstimate(graph, {.free = {1, 11, 12, 13}});
  EXPECT_EQ(graph.vertex<VertexXY>(10).estimate(), (Vector<double, 2>(7.0, 7.0)));
  EXPECT_NE(graph.vertex<VertexXY>(11).estimate(), (Vector<double, 2>(7.0, 7.0)));
}

TEST(ChordalLandmarks, AreToldAlongChainsInAnyDirection) {
  constexpr int points = 60000;  // a minute and more if turns were taken over all edges
  Graph graph = pointsInARow(points);
  EXPECT_THAT(chordalEstimate(graph, {}), ::testing::HasSubstr("60000 other vertices"));
  EXPECT_NEAR(graph.vertex<VertexXY>(10).estimate()[0], 0.0, 1e-6);
  EXPECT_NEAR(graph.vertex<VertexXY>(10 + points / 2).estimate()[1], 0.25 * points, 1e-6);
}

TEST(ChordalLandmarks, AFailedGuessLeavesEstimatesAsTheyWere) {
  Graph graph = camerasInARow(false);
  const Vector<double, 3> before = graph.vertex<VertexXYZ>(103).estimate();
  EXPECT_THROW((void)chordalEstimate(graph, {}), GraphError);
  EXPECT_EQ(graph.vertex<VertexSE3>(5).estimate().translation()[0], 0.0);
  EXPECT_EQ(graph.vertex<VertexXYZ>(103).estimate(), before);
  EXPECT_TRUE(graph.findVertex(103)->hasEstimate());
}

TEST(ChordalLandmarks, AGuessThatIsStoppedSaysSo) {
  Graph graph = camerasInARow(true);
  EXPECT_THROW((void)chordalEstimate(graph, {.timeLimit = 0.0}), WorkStopped);
  EXPECT_EQ(graph.vertex<VertexSE3>(5).estimate().translation()[0], 0.0);
}

TEST(ChordalLandmarks, TheFirstPoseThatHasAnEstimateKeepsIt) {
  Graph graph = pointsInARow(2);
  graph.vertex<VertexSE2>(0).setHasEstimate(false);
  graph.vertex<VertexSE2>(1).setEstimate(SE2<double>(6.0, 5.0, 0.0));
  (void)chordalEstimate(graph, {});
  EXPECT_NEAR(graph.vertex<VertexSE2>(0).estimate().translation()[0], 5.0, 1e-9);
  EXPECT_NEAR(graph.vertex<VertexSE2>(0).estimate().translation()[1], 5.0, 1e-9);
}

}  // namespace
}  // namespace quiver
