// The ways in which the whole world of a bundle adjustment may move unnoticed.
#include <gtest/gtest.h>

#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/types_sba/edge_cam.h>
#include <quiver/types_sba/edge_project_bal.h>
#include <quiver/types_sba/edge_project_cam.h>
#include <quiver/types_sba/edge_project_inverse_depth.h>
#include <tests/types_sba/bundle_problem.h>

namespace quiver {
namespace {

using test::BundleProblem;

/// Free directions of a graph that is one component.
int freeDirections(Graph& graph) {
  const Problem problem(graph, {});
  const std::vector<ComponentGauge> gauges = findGauges(problem);
  EXPECT_EQ(gauges.size(), 1u);
  EXPECT_TRUE(gauges[0].tested);
  return gauges[0].free;
}

TEST(BundleGauge, SevenForOneCameraSixForTwo) {
  BundleProblem mono;
  EXPECT_EQ(freeDirections(mono.withPixels().graph), 7);

  BundleProblem base;
  Graph stereo(base.graph.registry());
  Vector<double, 5> k;
  k << 500.0, 500.0, 320.0, 240.0, 0.2;
  for (int i = 0; i < BundleProblem::poses; ++i) stereo.addVertex<VertexCam>(i, {BundleProblem::pose(i), k});
  for (int j = 0; j < BundleProblem::points; ++j) {
    stereo.addVertex<VertexXYZ>(100 + j, BundleProblem::point(j));
    for (int i = 0; i < BundleProblem::poses; ++i)
      stereo.addEdge<EdgeProjectP2SC>({100 + j, i}, {1.0, 2.0, 3.0}, Matrix<double, 3, 3>::Identity());
  }
  EXPECT_EQ(freeDirections(stereo), 6);
}

TEST(BundleGauge, WhatHoldsTheWorld) {
  BundleProblem problem;
  problem.withPixels();
  problem.graph.findVertex(0)->setFixed(true);
  EXPECT_EQ(freeDirections(problem.graph), 1);  // the scale, about the camera
  problem.graph.findVertex(1)->setFixedDirections(1);
  EXPECT_EQ(freeDirections(problem.graph), 0);
  problem.graph.findVertex(1)->setFixedDirections(0);
  problem.graph.findVertex(1)->setFixed(true);
  EXPECT_EQ(freeDirections(problem.graph), 0);
}

TEST(BundleGauge, AKnownDistanceTellsTheScale) {
  BundleProblem base;
  Graph graph(base.graph.registry());
  for (int i = 0; i < BundleProblem::poses; ++i)
    graph.addVertex<VertexCam>(i, {BundleProblem::pose(i), {500, 500, 320, 240, 0}});
  for (int j = 0; j < BundleProblem::points; ++j) {
    graph.addVertex<VertexXYZ>(100 + j, BundleProblem::point(j));
    for (int i = 0; i < BundleProblem::poses; ++i)
      graph.addEdge<EdgeProjectP2MC>({100 + j, i}, BundleProblem::pixel(i, j), Matrix<double, 2, 2>::Identity());
  }
  EXPECT_EQ(freeDirections(graph), 7);
  graph.addEdge<EdgeScale>({0, 3}, 2.0, Matrix<double, 1, 1>::Identity());
  EXPECT_EQ(freeDirections(graph), 6);
}

TEST(BundleGauge, EstimatedIntrinsicsAndAnchoredPointsKeepTheSeven) {
  BundleProblem base;
  Graph graph = base.graph;
  graph.addVertex<VertexPinhole>(50, BundleProblem::intrinsics());
  for (int j = 0; j < BundleProblem::points; ++j) {
    for (int i = 0; i < BundleProblem::poses; ++i)
      graph.addEdge<EdgeProjectPinholeIntrinsics>({i, 100 + j, 50}, BundleProblem::pixel(i, j),
                                                  Matrix<double, 2, 2>::Identity());
  }
  EXPECT_EQ(freeDirections(graph), 7);

  Graph anchored(base.graph.registry());
  anchored.addParameter<ParameterCameraParameters>(0, {500.0, 320.0, 240.0, 0.0});
  for (int i = 0; i < BundleProblem::poses; ++i) anchored.addVertex<VertexSE3>(i, BundleProblem::pose(i));
  for (int j = 0; j < BundleProblem::points; ++j) {
    const Vector<double, 3> p = BundleProblem::pose(0).actInverse(BundleProblem::point(j));
    anchored.addVertex<VertexInverseDepth>(100 + j, {p[0] / p[2], p[1] / p[2], 1.0 / p[2]});
    anchored.addEdge<EdgeProjectInverseDepthAnchor>({100 + j}, {1.0, 2.0}, Matrix<double, 2, 2>::Identity(), {0});
    for (int i = 1; i < BundleProblem::poses; ++i)
      anchored.addEdge<EdgeProjectInverseDepth>({100 + j, i, 0}, {1.0, 2.0}, Matrix<double, 2, 2>::Identity(), {0});
  }
  EXPECT_EQ(freeDirections(anchored), 7);
}

TEST(BundleGauge, IsReported) {
  BundleProblem problem;
  problem.withPixels();
  for (const char* algorithm : {"auto", "lm", "gn"}) {
    Graph graph = problem.graph;
    Options options;
    options.algorithm = algorithm;
    const Summary summary = optimize(graph, options);
    EXPECT_NE(summary.gauge.reason.find("7 directions are free"), std::string::npos) << summary.gauge.reason;
    EXPECT_LT(summary.finalChi2, 1e-12) << algorithm;
  }
}

}  // namespace
}  // namespace quiver
