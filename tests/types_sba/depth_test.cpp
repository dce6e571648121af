#include <gtest/gtest.h>

#include <quiver/types_sba/depth.h>
#include <quiver/types_sba/edge_project_bal.h>
#include <quiver/types_sba/edge_project_cam.h>
#include <tests/types_sba/bundle_problem.h>

namespace quiver {
namespace {

using test::BundleProblem;

TEST(Depth, CountsPointsBehindTheirCameras) {
  BundleProblem problem;
  problem.withPixels();
  DepthSurvey survey = surveyDepth(problem.graph);
  EXPECT_EQ(survey.observations, BundleProblem::poses * BundleProblem::points);
  EXPECT_EQ(survey.behind, 0);
  EXPECT_EQ(survey.first, nullptr);
  problem.graph.vertex<VertexXYZ>(104).setEstimate({0.0, 0.0, -3.0});
  problem.graph.vertex<VertexXYZ>(107).setEstimate({0.0, 0.0, -3.0});
  survey = surveyDepth(problem.graph);
  EXPECT_EQ(survey.behind, 2 * BundleProblem::poses);
  ASSERT_NE(survey.first, nullptr);
  EXPECT_EQ(survey.first->vertexId(1), 104);
  // What has no estimate cannot be judged.
  problem.graph.findVertex(104)->setHasEstimate(false);
  survey = surveyDepth(problem.graph);
  EXPECT_EQ(survey.observations, BundleProblem::poses * (BundleProblem::points - 1));
  EXPECT_EQ(survey.behind, BundleProblem::poses);
}

TEST(Depth, KnowsWhereEachCameraLooks) {
  Graph graph(builtinRegistry());
  VertexCameraBal& bal = graph.addVertex<VertexCameraBal>(0);
  bal.setNumbers({0, 0, 0, 0, 0, 0, 500, 0, 0});
  graph.addVertex<VertexCam>(1, PosedCamera<double>());
  graph.addVertex<VertexXYZ>(2, {0.0, 0.0, 5.0});
  graph.addEdge<EdgeProjectBal>({0, 2}, {0.0, 0.0}, Matrix<double, 2, 2>::Identity());
  graph.addEdge<EdgeProjectP2MC>({2, 1}, {0.0, 0.0}, Matrix<double, 2, 2>::Identity());
  EXPECT_EQ(surveyDepth(graph).behind, 1);
  graph.vertex<VertexXYZ>(2).setEstimate({0.0, 0.0, -5.0});
  EXPECT_EQ(surveyDepth(graph).behind, 1);
  graph.forEachEdge([&](const Edge& edge) {
    if (graph.typeOf(edge).tag() == "EDGE_PROJECT_BAL") {
      EXPECT_TRUE(isDepthPositive(graph, static_cast<const EdgeProjectBal&>(edge)));
    } else {
      EXPECT_FALSE(isDepthPositive(graph, static_cast<const EdgeProjectP2MC&>(edge)));
    }
  });
}

}  // namespace
}  // namespace quiver
