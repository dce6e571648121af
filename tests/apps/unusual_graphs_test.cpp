// Graphs that are right and seldom: floors, tiny information, a part alone, no error at all.
#include <cstdio>
#include <string>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

class UnusualGraphs : public CommandTest {};

TEST_F(UnusualGraphs, AFloorIsSeenFromAbove) {
  // The seen normal is that of the z axis, where the azimuth is open.
  for (const char* floor : {"0 0 1 -2.5", "0.1 0 0.995 -2.5", "0 0 -1 -2.5"}) {
    write("floor.g2o",
          "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nFIX 0\nVERTEX_SE3:QUAT 9 0 0 0 0 0 0 1\nFIX 9\n"
          "VERTEX_PLANE 1 0 0 1 -2 1 1 1\nEDGE_SE3_PLANE_CALIB 0 1 9 " +
              std::string(floor) + " 1 1 1 1 0 0 1 0 1\n");
    const auto report = optimize("floor.g2o --algorithm lm");
    if (std::string(floor) == "0 0 1 -2.5") {
      EXPECT_LT(report["final_chi2"], 1e-18) << floor;
    } else {
      EXPECT_LT(report["final_chi2"], report["initial_chi2"]) << floor;
    }
  }
}

TEST_F(UnusualGraphs, TheUnitOfInformationDoesNotMatter) {
  for (const char* information : {"1 0 1", "1e-10 0 1e-10", "1e10 0 1e10"}) {
    const std::string end = std::string(information) + "\n";
    write("points.g2o",
          "VERTEX_XY 0 0 0\nFIX 0\nVERTEX_XY 1 5 5\nEDGE_POINTXY 0 1 1 0 " + end + "EDGE_PRIOR_XY 1 3 0 " + end);
    for (const char* algorithm : {"auto", "lm", "dogleg"}) {
      (void)optimize("points.g2o -o out.g2o --algorithm " + std::string(algorithm));
      double x = 0.0, y = 0.0;
      const std::string text = read("out.g2o");
      const auto at = text.find("VERTEX_XY 1 ");
      ASSERT_NE(at, std::string::npos);
      ASSERT_EQ(std::sscanf(text.c_str() + at, "VERTEX_XY 1 %lf %lf", &x, &y), 2);
      EXPECT_NEAR(x, 2.0, 1e-4) << information << ' ' << algorithm;
      EXPECT_NEAR(y, 0.0, 1e-4) << information << ' ' << algorithm;
    }
  }
}

TEST_F(UnusualGraphs, NoErrorIsLeft) {
  write("one.g2o", "VERTEX_XY 0 0 0\nEDGE_PRIOR_XY 0 1 1 1 0 1\n");
  EXPECT_EQ(optimize("one.g2o")["reason"], "the cost is zero");
}

TEST_F(UnusualGraphs, APartMovesAloneWhateverTheStart) {
  write("part.g2o",
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1.5 0.3 0\nVERTEX_SE2 2 2 0.7 0.4\nVERTEX_SE2 3 3 0 0\n"
        "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 2 3 1 0 0 1 0 0 1 0 1\n"
        "EDGE_SE2 0 3 3.3 0 0 1 0 0 1 0 1\n");
  const double expected = optimize("part.g2o --only 2 --init file")["final_chi2"];
  for (const char* start : {"auto", "tree", "odometry", "chordal"}) {
    const auto report = optimize("part.g2o -o out.g2o --only 2 --init " + std::string(start));
    EXPECT_NEAR(report["final_chi2"], expected, 1e-9) << start;
    EXPECT_NE(read("out.g2o").find("VERTEX_SE2 1 1.5 0.3 0\n"), std::string::npos) << start;
    EXPECT_NE(read("out.g2o").find("VERTEX_SE2 3 3 0 0\n"), std::string::npos) << start;
  }
}

TEST_F(UnusualGraphs, WhatHasAnEstimateIsNotMovedByWhatHasNone) {
  write("segment.g2o",
        "VERTEX_SE2 0 5 5 0\n#quiver vertex VERTEX_SEGMENT2D 5\n"
        "EDGE_SE2_SEGMENT2D 0 5 1 1 1 3 1 0 0 0 1 0 0 1 0 1\n");
  (void)optimize("segment.g2o -o out.g2o");
  EXPECT_NE(read("out.g2o").find("VERTEX_SE2 0 5 5 0\n"), std::string::npos) << read("out.g2o");
  EXPECT_NE(read("out.g2o").find("VERTEX_SEGMENT2D 5 6 6 6 8\n"), std::string::npos) << read("out.g2o");

  write("odometry.g2o",
        "#quiver vertex VERTEX_SE2 0\nVERTEX_SE2 1 5 5 0\nVERTEX_SE2 2 6 6 0\n"
        "EDGE_SE2 0 1 1 1 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 1 0 1 0 0 1 0 1\n");
  for (const char* start : {"auto", "tree", "odometry", "chordal"}) {
    (void)optimize("odometry.g2o -o out.g2o --init " + std::string(start));
    for (int id = 0; id < 3; ++id) {
      const std::string text = read("out.g2o"), tag = "VERTEX_SE2 " + std::to_string(id) + " ";
      double x = 0.0, y = 0.0;
      ASSERT_NE(text.find(tag), std::string::npos) << text;
      ASSERT_EQ(std::sscanf(text.c_str() + text.find(tag) + tag.size(), "%lf %lf", &x, &y), 2);
      EXPECT_NEAR(x, 4.0 + id, 1e-6) << start;
      EXPECT_NEAR(y, 4.0 + id, 1e-6) << start;
    }
  }

  write("line.g2o", "VERTEX_SE2 0 0 0 0\n#quiver vertex VERTEX_SEGMENT2D 5\nEDGE_SE2_SEGMENT2D_LINE 0 5 0 2 1 0 1\n");
  const CommandResult untold = run("optimize line.g2o");
  EXPECT_EQ(untold.exitCode, 3);
  EXPECT_NE(untold.err.find("no edge tells where vertex 5 (VERTEX_SEGMENT2D)"), std::string::npos) << untold.err;
}

TEST_F(UnusualGraphs, AnOutputWithoutANameIsRefused) {
  write("one.g2o", "VERTEX_XY 0 0 0\nEDGE_PRIOR_XY 0 1 1 1 0 1\n");
  for (const char* arguments : {"optimize one.g2o -o ''", "optimize one.g2o --json ''", "info one.g2o --json ''",
                                "list --json ''", "simulate sphere -o s.g2o --truth ''"}) {
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exitCode, 2) << arguments;
    EXPECT_NE(result.err.find("the path of the file to write is empty"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace quiver::test
