#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PlotCommand : public CommandTest {
 protected:
  std::string drawn(const std::string& arguments) const {
    const CommandResult result = run("plot " + arguments + " -o picture.svg");
    EXPECT_EQ(result.exitCode, 0) << arguments << '\n' << result.err;
    return read("picture.svg");
  }
};

/// Two poses of a type, one measurement between them unless the type has none.
struct PosesOfAType {
  const char* name;
  const char* text;
  bool joined;
};

TEST_F(PlotCommand, DrawsPosesOfAllTypes) {
  for (const auto& [name, text, joined] :
       {PosesOfAType{"quaternions", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\n", false},
        PosesOfAType{"TORO", "VERTEX3 0 0 0 0 0 0 0\nVERTEX3 1 1 0 0 0 0 0\n", false},
        PosesOfAType{"exponential map", "VERTEX_SE3:EXPMAP 0 0 0 0 0 0 0 1\nVERTEX_SE3:EXPMAP 1 1 0 0 0 0 0 1\n",
                     false},
        PosesOfAType{"cameras",
                     "VERTEX_CAM 0 0 0 0 0 0 0 1 300 300 320 320 0.1\nVERTEX_CAM 1 1 0 0 0 0 0 1 300 300 320 320 0.1\n"
                     "EDGE_SCALE 0 1 1 1\n",
                     true},
        PosesOfAType{"similarities",
                     "VERTEX_SIM3:EXPMAP 0 0 0 0 0 0 0 0 300 300 320 320\nVERTEX_SIM3:EXPMAP 1 0 0 0 1 0 0 0 300 300 "
                     "320 320\n",
                     false},
        PosesOfAType{"bundle adjustment",
                     "VERTEX_CAMERA:BAL 0 0 0 0 0 0 0 500 0 0\nVERTEX_CAMERA:BAL 1 0 0 0 -1 0 0 500 0 0\n", false}}) {
    write("poses.g2o", text);
    const std::string picture = drawn("poses.g2o");
    EXPECT_THAT(picture, HasSubstr(">2 poses, ")) << name;
    EXPECT_THAT(picture, Not(HasSubstr("not drawn"))) << name;
    // Isometric: one metre along x is √3/2 to the right and ½ down; they fill 592 pixels around (320, 376).
    EXPECT_THAT(picture, HasSubstr(joined ? "M24.0 205.1L616.0 546.9" : "M24.0 205.1h0M616.0 546.9h0")) << name;
  }
}

TEST_F(PlotCommand, DrawsTypesOfPluginsThatSayWhereTheyAre) {
  write("in.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 5 0 0\nVERTEX_BEACON 100 0 4\nEDGE_RANGE_SE2_XY 0 100 5.5 10\n");
  const std::string picture = drawn(fmt::format("in.g2o --plugin '{}'", QUIVER_TEST_BEACONS));
  EXPECT_THAT(picture, HasSubstr(">2 poses, 1 landmark"));
  EXPECT_THAT(picture, HasSubstr("class=\"sighting\""));
}

TEST_F(PlotCommand, DrawsCamerasThatShareButWhatTheySee) {
  ASSERT_EQ(run("simulate bundle -o b.bal --cameras 20 --points 300").exitCode, 0);
  const std::string picture = drawn("b.bal");
  EXPECT_THAT(picture, HasSubstr(">20 poses, 300 landmarks, "));
  EXPECT_THAT(picture, HasSubstr("class=\"pose\""));
  EXPECT_THAT(picture, HasSubstr("class=\"sighting\""));
  EXPECT_THAT(picture, HasSubstr(">poses not joined<"));
  EXPECT_THAT(picture, HasSubstr(">landmarks<"));
}

TEST_F(PlotCommand, DrawsSightingsOfAllArities) {
  write("three.g2o",
        "VERTEX_CAM 0 0 0 0 0 0 0 1 300 300 320 320 0.1\nVERTEX_TRACKXYZ 1 0 0 5\n"
        "VERTEX_INTRINSICS 2 300 300 320 320 0.1\nEDGE_PROJECT_P2MC_INTRINSICS 1 0 2 320 320 1 0 1\n");
  const std::string three = drawn("three.g2o");
  EXPECT_THAT(three, HasSubstr("class=\"sighting\""));
  EXPECT_THAT(three, HasSubstr("; not drawn: 1 vertex without place<"));
  write("lots.g2o",
        "VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 1 0\nVERTEX_XY 2 0 1\n"
        "EDGE_SE2_LOTSOFXY 0 1 2 || 2 1 0 0 1 1 0 0 0 1 0 0 1 0 1\n");
  EXPECT_THAT(drawn("lots.g2o"), HasSubstr("L616.0 672.0"));
}

TEST_F(PlotCommand, PlacesPointsOfInverseDepthByTheirAnchor) {
  // ψ = (0, 0, 1/4) in the anchor at (1, 0, 0), seen by the pose at the origin: the point is at (1, 0, 4). The next is
  // at infinity.
  write("psi.g2o",
        "PARAMS_CAMERAPARAMETERS 0 100 0 0 0\nVERTEX_TRACKXYZ 0 0 0 0.25\nVERTEX_TRACKXYZ 3 0 0 0\n"
        "VERTEX_SE3:EXPMAP 1 0 0 0 0 0 0 1\nVERTEX_SE3:EXPMAP 2 1 0 0 0 0 0 1\n"
        "EDGE_PROJECT_PSI2UV:EXPMAP 0 1 2 0 25 0 1 0 1\nEDGE_PROJECT_PSI2UV:EXPMAP 3 1 2 0 0 0 1 0 1\n");
  const std::string picture = drawn("psi.g2o");
  EXPECT_THAT(picture, HasSubstr(">2 poses, 1 landmark, "));
  EXPECT_THAT(picture, HasSubstr("; not drawn: 1 vertex without place<"));
  // From (0, 0) to (√3/2, 3½) in a picture that is 4 m high, from −½ to 3½, 592 pixels from 80 to 672.
  EXPECT_THAT(picture, HasSubstr("M255.9 598.0L384.1 80.0"));
}

TEST_F(PlotCommand, AFewFarLandmarksDoNotShrinkThePicture) {
  std::string text = "VERTEX_SE2 0 0 0 0\n";
  for (int i = 1; i <= 200; ++i) text += fmt::format("VERTEX_XY {} {} {}\n", i, i % 20, i / 20);
  write("near.g2o", text);
  EXPECT_THAT(drawn("near.g2o"), Not(HasSubstr("beyond the frame")));
  write("far.g2o", text + "VERTEX_XY 201 1e6 0\n");
  const std::string far = drawn("far.g2o");
  EXPECT_THAT(far, HasSubstr("; not drawn: 1 landmark beyond the frame<"));
  EXPECT_THAT(far, HasSubstr(">2 m<")) << "the scale is that of the near ones";
}

TEST_F(PlotCommand, SaysWhyNothingCanBeDrawn) {
  write("edges.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  const CommandResult nothing = run("plot edges.g2o -o x.svg");
  EXPECT_EQ(nothing.exitCode, 3);
  EXPECT_THAT(nothing.err, HasSubstr("edges.g2o: nothing to draw: of 2 vertices, 2 without estimate"));
  write("plane.g2o", "VERTEX_PLANE 0 0 0 1 -1 0 0 0\n");
  EXPECT_THAT(run("plot plane.g2o -o x.svg").err,
              HasSubstr("plane.g2o: nothing to draw: of 1 vertex, 0 without estimate, and 1 of types"));
}

TEST_F(PlotCommand, RefusesAnExtentThatIsNotFinite) {
  write("huge.g2o", "VERTEX_SE2 0 1e308 0 0\nVERTEX_SE2 1 -1e308 0 0\n");
  const CommandResult result = run("plot huge.g2o -o picture.svg");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_THAT(result.err, ::testing::StartsWith("huge.g2o: the extent of the estimates is not finite"));
  EXPECT_FALSE(exists("picture.svg"));
  write("far.g2o", "VERTEX_SE2 0 1e308 1e308 0\nVERTEX_SE2 1 1.5e308 1e308 0\n");
  const std::string picture = drawn("far.g2o");
  EXPECT_THAT(picture, Not(HasSubstr("nan")));
  EXPECT_THAT(picture, Not(HasSubstr("inf")));
}

TEST_F(PlotCommand, StructureNeedsNoEstimates) {
  const std::string edges =
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 2 3 1 0 0 1 0 0 1 0 1\n";
  write("edges.g2o", edges);
  write("whole.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 2 0 0\nVERTEX_SE2 3 3 0 0\n" + edges);
  const CommandResult without = run("plot edges.g2o --structure -o edges.svg");
  EXPECT_EQ(without.exitCode, 0) << without.err;
  EXPECT_THAT(without.out, HasSubstr("H: 4 blocks, 12 unknowns a side; 10 blocks stored, 90 numbers"));
  EXPECT_EQ(without.out, run("plot whole.g2o --structure -o whole.svg").out);
  EXPECT_EQ(read("edges.svg"), read("whole.svg"));
}

TEST_F(PlotCommand, NoMatrixIsMoreThanFull) {
  write("pair.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  const CommandResult result = run("plot pair.g2o --structure -o x.svg");
  // A lower triangle of six numbers a side.
  EXPECT_THAT(result.out, HasSubstr("factor: 2 blocks, 6 unknowns a side; 3 blocks stored, 21 numbers, 100 % full"));
  EXPECT_THAT(read("x.svg"), HasSubstr("21 numbers, 100 % full"));
}

TEST_F(PlotCommand, RefusesWhatMakesNoSense) {
  write("in.g2o", square);
  EXPECT_EQ(run("plot in.g2o -o ''").exitCode, 2);
  EXPECT_EQ(run("plot in.g2o --before '' -o x.svg").exitCode, 2);
  EXPECT_EQ(run("plot - --before - -o x.svg < in.g2o").exitCode, 2);
  EXPECT_EQ(run("plot in.g2o --before in.g2o --structure -o x.svg").exitCode, 2);
  EXPECT_EQ(run("plot in.g2o -o no/x.svg").exitCode, 6);
  EXPECT_EQ(run("plot no.g2o -o x.svg").exitCode, 3);
  EXPECT_FALSE(exists("x.svg"));
}

TEST_F(PlotCommand, NoPictureOrReportReplacesAGraph) {
  write("in.g2o", square);
  for (const char* command :
       {"plot in.g2o -o in.g2o", "plot in.g2o -o ./in.g2o", "plot in.g2o --structure -o in.g2o",
        "evaluate in.g2o in.g2o -o in.g2o", "evaluate in.g2o in.g2o --json ./in.g2o", "info in.g2o --json in.g2o",
        "optimize in.g2o --json in.g2o", "optimize in.g2o -o x.g2o --json ./x.g2o"}) {
    EXPECT_EQ(run(command).exitCode, 2) << command;
    EXPECT_EQ(read("in.g2o"), square) << command;
  }
  EXPECT_EQ(run("optimize in.g2o -o /dev/null --json /dev/null").exitCode, 0) << "a device takes both";
  EXPECT_EQ(run("optimize in.g2o -o in.g2o --quiet").exitCode, 0) << "a graph may replace itself";
}

}  // namespace
}  // namespace quiver::test
