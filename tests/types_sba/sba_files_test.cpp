// Every tag of g2o's camera types in a file: read, written, read again.
#include <algorithm>

#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_sba/expmap/edge_se3_project_xyz.h>
#include <quiver/types_sba/sim3/edge_sim3.h>
#include <quiver/types_sba/vertex_cam.h>

namespace quiver {
namespace {

Graph read(const std::string& text) { return readGraphText(text, "cameras.g2o", builtinRegistry()); }

const char* const everything =
    "PARAMS_CAMERAPARAMETERS 0 500 320 240 0.1\n"
    "VERTEX_CAM 0 0 0 0 0 0 0 1 500 500 320 240 0.1\n"
    "VERTEX_CAM 1 0.1 0.2 0.3 0.1 0.2 0.3 0.9273618495495703 510 490 310 230 0.2\n"
    "VERTEX_TRACKXYZ 2 0.5 -0.25 4\n"
    "VERTEX_INTRINSICS 3 500 500 320 240 0.1\n"
    "VERTEX_SE3:EXPMAP 4 0.1 0.2 0.3 0.1 0.2 0.3 0.9273618495495703\n"
    "VERTEX_SE3:EXPMAP 5 0.2 0.1 0 -0.1 0.2 -0.3 0.9273618495495703\n"
    "VERTEX_SIM3:EXPMAP 6 0.1 -0.2 0.3 1 2 3 0.25 500 510 320 240 400 410 300 200\n"
    "VERTEX_SIM3:EXPMAP 7 -0.4 0.7 0.1 0.3 0.1 0.2 -0.15 500 510 320 240 400 410 300 200\n"
    "VERTEX_TRACKXYZ 8 0.1 -0.2 0.25\n"
    "VERTEX_CAMERA:BAL 9 0.1 -0.2 0.3 1 2 -3 700 -0.1 0.01\n"
    "EDGE_CAM 0 1 0.1 0.2 0.3 0.1 0.2 0.3 0.9273618495495703 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
    "EDGE_PROJECT_BAL 9 2 10 20 1 0 1\n"
    "EDGE_PROJECT_INVERSE_SIM3_XYZ:EXPMAP 2 6 300 200 1 0.1 2\n"
    "EDGE_PROJECT_P2MC 2 0 382.5 208.75 1 0 1\n"
    "EDGE_PROJECT_P2MC_INTRINSICS 2 1 3 380 210 1 0 1\n"
    "EDGE_PROJECT_P2SC 2 1 380 210 370 1 0 0 1 0 1\n"
    "EDGE_PROJECT_PSI2UV:EXPMAP 8 4 5 0 370 240 1 0 1\n"
    "EDGE_PROJECT_SIM3_XYZ:EXPMAP 2 7 300 200 1 0.1 2\n"
    "EDGE_PROJECT_XYZ2UV:EXPMAP 2 4 0 370 240 1 0 1\n"
    "EDGE_PROJECT_XYZ2UVU:EXPMAP 2 4 0 370 240 360 1 0 0 1 0 1\n"
    "EDGE_SCALE 0 1 0.4 100\n"
    "EDGE_SE3:EXPMAP 4 5 0.1 0.2 0.3 0.1 0.2 0.3 0.9273618495495703 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
    "EDGE_SE3_PROJECT_XYZ:EXPMAP 2 4 370 240 1 0 1 500 510 320 240\n"
    "EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP 4 370 240 1 0 1 500 510 320 240 0.5 -0.25 4\n"
    "EDGE_SIM3:EXPMAP 6 7 0.1 0.2 0.3 0.4 0.5 0.6 0.7 1 0 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
    "EDGE_STEREO_SE3_PROJECT_XYZ:EXPMAP 2 4 370 240 360 1 0 0 1 0 1 500 510 320 240 50\n"
    "EDGE_STEREO_SE3_PROJECT_XYZONLYPOSE:EXPMAP 4 370 240 360 1 0 0 1 0 1 500 510 320 240 50 0.5 -0.25 4\n";

/// The lines of a text, in order.
std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    result.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  std::sort(result.begin(), result.end());
  return result;
}

TEST(CameraFiles, AllTagsKeepEveryDigit) {
  const std::string once = graphText(read(everything));
  EXPECT_EQ(lines(once), lines(everything));
  EXPECT_EQ(graphText(read(once)), once);
}

TEST(CameraFiles, WhatG2oLeavesOutHasItsDefaults) {
  const Graph graph = read(
      "VERTEX_CAM 0 0 0 0 0 0 0 1\nVERTEX_TRACKXYZ 1 0 0 1\nVERTEX_SE3:EXPMAP 2 0 0 0 0 0 0 1\n"
      "VERTEX_SIM3:EXPMAP 3 0 0 0 0 0 0 0 500 510 320 240\n"
      "EDGE_PROJECT_P2MC 1 0 320 320 1 0 1\nEDGE_SE3_PROJECT_XYZ:EXPMAP 1 2 0.5 0.5 1 0 1\n");
  EXPECT_EQ(graph.vertex<VertexCam>(0).estimate().intrinsics, PosedCamera<double>().intrinsics);
  const CameraSimilarity<double> similarity = graph.vertex<VertexSim3Expmap>(3).estimate();
  for (int i = 0; i < 4; ++i) EXPECT_EQ(similarity.intrinsics[i], similarity.intrinsics[i + 4]);
  graph.forEachEdge([&](const Edge& edge) {
    if (graph.typeOf(edge).tag() != "EDGE_SE3_PROJECT_XYZ:EXPMAP") return;
    Vector<double, 6> expected;
    expected << 0.5, 0.5, 1.0, 1.0, 0.5, 0.5;
    EXPECT_EQ(static_cast<const EdgeSE3ProjectXYZ&>(edge).measurement(), expected);
  });
}

TEST(CameraFiles, AnEdgeWithoutItsPointIsRefused) {
  const std::string vertices = "VERTEX_SE3:EXPMAP 0 0 0 0 0 0 0 1\n";
  try {
    read(vertices + "EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP 0 1 2 1 0 1\n");
    ADD_FAILURE() << "accepted";
  } catch (const ParseError& error) {
    EXPECT_EQ(error.line(), 2);
    EXPECT_NE(error.message().find("field 'fx'"), std::string::npos) << error.what();
  }
  EXPECT_THROW(read(vertices + "EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP 0 1 2 1 0 1 500 500 320 240 1 2\n"), ParseError);
  EXPECT_THROW(read(vertices + "EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP 0 1 2 1 0 1 500 500 320 240 1 2 3 4\n"),
               ParseError);
}

/// Pixels that differ only behind the information matrix still have one order: the lines' order reaches no bit.
TEST(CameraFiles, OrderOfLinesDoesNotMatterForTails) {
  std::vector<std::string> edges;
  for (int i = 0; i < 40; ++i) {
    edges.push_back("EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP 0 320 240 1 0 1 500 510 320 240 0." +
                    std::to_string(i * 37 % 40) + "1 -0.3" + std::to_string(i) + " 4." + std::to_string(i * 11 % 7) +
                    "\n");
  }
  const auto chi2 = [&] {
    std::string text = "VERTEX_SE3:EXPMAP 0 0.1 0.2 0.3 0.1 0.2 0.3 0.9273618495495703\n";
    for (const std::string& edge : edges) text += edge;
    Graph graph = read(text);
    return optimize(graph, {.maxIterations = 5}).finalChi2;
  };
  const double once = chi2();
  std::reverse(edges.begin(), edges.end());
  EXPECT_EQ(chi2(), once);
  std::rotate(edges.begin(), edges.begin() + 13, edges.end());
  EXPECT_EQ(chi2(), once);
}

TEST(CameraFiles, AScaleBeyondNumbersIsRefused) {
  try {
    read("VERTEX_SIM3:EXPMAP 3 0 0 0 0 0 0 800 500 510 320 240\n");
    ADD_FAILURE() << "accepted";
  } catch (const ParseError& error) {
    EXPECT_NE(error.message().find("scale"), std::string::npos) << error.what();
  }
}

TEST(CameraFiles, AliasOfTheInverseDepthEdge) {
  const std::string text = std::string(everything);
  const std::size_t at = text.find("EDGE_PROJECT_PSI2UV:EXPMAP");
  std::string renamed = text;
  renamed.replace(at, std::string("EDGE_PROJECT_PSI2UV:EXPMAP").size(), "EDGE_PROJECT_PSI2UV");
  EXPECT_EQ(graphText(read(renamed)), graphText(read(text)));
}

}  // namespace
}  // namespace quiver
