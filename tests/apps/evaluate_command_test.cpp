#include <cmath>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class EvaluateCommand : public CommandTest {};

TEST_F(EvaluateCommand, ComparesGraphsAfterAlignment) {
  write("truth.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 1 1 0\n");
  // The same triangle turned by a right angle and moved.
  write("turned.g2o",
        "VERTEX_SE2 0 5 5 1.5707963267948966\nVERTEX_SE2 1 5 6 1.5707963267948966\nVERTEX_SE2 2 4 6 "
        "1.5707963267948966\n");
  const Json json = Json::parse(run("evaluate turned.g2o truth.g2o --json -").out);
  EXPECT_EQ(json["alignment"]["group"], "se2");
  EXPECT_EQ(json["matched_poses"], 3);
  EXPECT_NEAR(json["absolute"]["translation_m"]["max"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(json["absolute"]["rotation_rad"]["max"].get<double>(), 0.0, 1e-12);
  const Json none = Json::parse(run("evaluate turned.g2o truth.g2o --align none --json -").out);
  EXPECT_NEAR(none["absolute"]["translation_m"]["min"].get<double>(), std::sqrt(34.0), 1e-12);  // (4,6)-(1,1)
  EXPECT_NEAR(none["absolute"]["rotation_rad"]["mean"].get<double>(), 1.5707963267948966, 1e-12);
  const CommandResult table = run("evaluate turned.g2o truth.g2o -o e.svg");
  EXPECT_NE(table.out.find("absolute translation m"), std::string::npos);
  EXPECT_NE(read("e.svg").find("</svg>"), std::string::npos);
}

TEST_F(EvaluateCommand, ReadsTrajectoriesAndStandardInput) {
  write("a.txt", "# tum\n0 0 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n2 2 2 0 0 0 0 1\n");
  write("b.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 1 0 0 1 0\n");
  const CommandResult scaled = run("evaluate - b.txt --align sim3 --json - < a.txt");
  ASSERT_EQ(scaled.exitCode, 0) << scaled.err;
  EXPECT_NEAR(Json::parse(scaled.out)["alignment"]["scale"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(Json::parse(scaled.out)["absolute"]["translation_m"]["max"].get<double>(), 0.0, 1e-12);
}

TEST_F(EvaluateCommand, RefusesWhatMakesNoSense) {
  write("a.txt", "0 0 0 0 0 0 0 1\n1 2 0 0 0 0 0\n");
  write("b.txt", "0 0 0 0 0 0 0 1\n");
  const CommandResult bad = run("evaluate a.txt b.txt");
  EXPECT_EQ(bad.exitCode, 3);
  EXPECT_NE(bad.err.find("a.txt:2:"), std::string::npos) << bad.err;
  EXPECT_EQ(run("evaluate b.txt b.txt --align so3").exitCode, 2);
  EXPECT_EQ(run("evaluate b.txt b.txt --align se2").exitCode, 3);
  EXPECT_EQ(run("evaluate b.txt b.txt --step 2 --step-metres 1").exitCode, 2);
  EXPECT_EQ(run("evaluate - - < b.txt").exitCode, 2);
  EXPECT_EQ(run("evaluate b.txt b.txt -o missing/e.svg").exitCode, 6);
}

/// A pose at (1, 2, 3) turned by a right angle about z, and two that are not turned.
const char* const threePoses = "0 1 2 3 0 0 0.7071067811865476 0.7071067811865476\n1 4 5 6 0 0 0 1\n2 0 0 1 0 0 0 1\n";

TEST_F(EvaluateCommand, KnowsPosesOfAllTypes) {
  write("truth.txt", threePoses);
  struct Poses {
    const char* text;
    const char* what;
  };
  for (const auto& [text, what] :
       {Poses{"VERTEX_SE3:QUAT 0 1 2 3 0 0 0.7071067811865476 0.7071067811865476\nVERTEX_SE3:QUAT 1 4 5 6 0 0 0 1\n"
              "VERTEX_SE3:QUAT 2 0 0 1 0 0 0 1\n",
              "body to world"},
        Poses{"VERTEX_SE3:EXPMAP 0 1 2 3 0 0 0.7071067811865476 0.7071067811865476\nVERTEX_SE3:EXPMAP 1 4 5 6 0 0 0 1\n"
              "VERTEX_SE3:EXPMAP 2 0 0 1 0 0 0 1\n",
              "files hold camera to world"},
        Poses{"VERTEX3 0 1 2 3 0 0 1.5707963267948966\nVERTEX3 1 4 5 6 0 0 0\nVERTEX3 2 0 0 1 0 0 0\n", "TORO"},
        Poses{"VERTEX_CAM 0 1 2 3 0 0 0.7071067811865476 0.7071067811865476 300 300 320 320 0.1\n"
              "VERTEX_CAM 1 4 5 6 0 0 0 1 300 300 320 320 0.1\nVERTEX_CAM 2 0 0 1 0 0 0 1 300 300 320 320 0.1\n",
              "camera to world, with intrinsics"},
        // With a right angle θ about z, t = V ρ and V⁻¹ = π/4 [1 1; −1 1]; with a scale 2 alone, t = ρ / ln 2.
        Poses{"VERTEX_SIM3:EXPMAP 0 0 0 1.5707963267948966 2.356194490192345 0.7853981633974483 3 0 300 300 320 320\n"
              "VERTEX_SIM3:EXPMAP 1 0 0 0 2.772588722239781 3.4657359027997265 4.1588830833596715 0.6931471805599453 "
              "300 300 320 320\nVERTEX_SIM3:EXPMAP 2 0 0 0 0 0 1 0 300 300 320 320\n",
              "camera to world, by the logarithm"},
        Poses{
            "VERTEX_CAMERA:BAL 0 0 0 -1.5707963267948966 -2 1 -3 500 0 0\nVERTEX_CAMERA:BAL 1 0 0 0 -4 -5 -6 500 0 0\n"
            "VERTEX_CAMERA:BAL 2 0 0 0 0 0 -1 500 0 0\n",
            "world to camera: the centre is -R't"}}) {
    write("estimate.g2o", text);
    const CommandResult result = run("evaluate estimate.g2o truth.txt --align none --json -");
    ASSERT_EQ(result.exitCode, 0) << what << '\n' << result.err;
    const Json absolute = Json::parse(result.out)["absolute"];
    EXPECT_EQ(absolute["translation_m"]["count"], 3) << what;
    EXPECT_NEAR(absolute["translation_m"]["max"].get<double>(), 0.0, 1e-12) << what;
    EXPECT_NEAR(absolute["rotation_rad"]["max"].get<double>(), 0.0, 1e-12) << what;
  }
}

TEST_F(EvaluateCommand, ReadsBundleAdjustmentFiles) {
  ASSERT_EQ(run("simulate bundle -o b.bal --truth t.bal --cameras 20 --points 300 --error-position 0.05").exitCode, 0);
  ASSERT_EQ(run("convert b.bal b.g2o").exitCode, 0);
  const Json same = Json::parse(run("evaluate b.bal b.g2o --align none --json -").out);
  EXPECT_EQ(same["matched_poses"], 20);
  EXPECT_EQ(same["matched_by"], "id");
  EXPECT_EQ(same["absolute"]["translation_m"]["max"], 0.0);
  const Json moved = Json::parse(run("evaluate b.bal t.bal --align none --json -").out);
  // 0.05 m an axis: √3 of it in space; sixty numbers scatter by a tenth.
  EXPECT_NEAR(moved["absolute"]["translation_m"]["rmse"].get<double>(), 0.05 * std::sqrt(3.0), 0.03);
}

TEST_F(EvaluateCommand, AStepBeyondTheEndIsRefused) {
  write("a.txt", threePoses);
  for (const char* step : {"--step 3", "--step 5000", "--step-metres 1000"}) {
    const CommandResult result = run(std::string("evaluate a.txt a.txt --json x.json ") + step);
    EXPECT_EQ(result.exitCode, 3) << step;
    EXPECT_NE(result.err.find("a.txt against a.txt: a step of "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("goes beyond the end"), std::string::npos) << result.err;
    EXPECT_FALSE(exists("x.json"));
  }
  EXPECT_EQ(Json::parse(run("evaluate a.txt a.txt --step 2 --json -").out)["relative"]["translation_m"]["count"], 1);
}

TEST_F(EvaluateCommand, ErrorsThatAreNotFiniteAreNoResult) {
  write("truth.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 1 1 0\n");
  write("huge.g2o", "VERTEX_SE2 0 1e308 0 0\nVERTEX_SE2 1 -1e308 0 0\nVERTEX_SE2 2 1 1 0\n");
  for (const char* align : {"none", "se2", "se3", "sim3"}) {
    const CommandResult result =
        run(std::string("evaluate huge.g2o truth.g2o -o e.svg --json e.json --align ") + align);
    EXPECT_EQ(result.exitCode, 3) << align;
    EXPECT_EQ(result.err.rfind("huge.g2o: the positions' extent", 0), 0u) << result.err;
    EXPECT_FALSE(exists("e.svg") || exists("e.json")) << align;
  }
  write("far.g2o", "VERTEX_SE2 0 1e300 0 0\nVERTEX_SE2 1 1e300 0 0\nVERTEX_SE2 2 1e300 0 0\n");
  const CommandResult apart = run("evaluate far.g2o truth.g2o --align none");
  EXPECT_EQ(apart.exitCode, 3);
  EXPECT_EQ(apart.err.rfind("far.g2o against truth.g2o: the positions' extent", 0), 0u) << apart.err;
}

TEST_F(EvaluateCommand, ASinglePoseHasNoRelativeError) {
  write("a.txt", "0 1 2 3 0 0 0 1\n");
  const CommandResult table = run("evaluate a.txt a.txt --align none");
  EXPECT_EQ(table.exitCode, 0) << table.err;
  EXPECT_NE(table.out.find("of a single pose there is none"), std::string::npos) << table.out;
  const Json json = Json::parse(run("evaluate a.txt a.txt --align none --json -").out);
  EXPECT_EQ(json["relative"]["translation_m"]["count"], 0);
  EXPECT_TRUE(json["relative"]["translation_m"]["rmse"].is_null());
  EXPECT_EQ(json["absolute"]["translation_m"]["rmse"], 0.0);
}

TEST_F(EvaluateCommand, MessagesNameTheFiles) {
  write("three.txt", threePoses);
  write("edges.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  write("points.g2o", "VERTEX_XY 0 0 0\n");
  write("pair.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n");
  const auto message = [&](const std::string& arguments, int exitCode) {
    const CommandResult result = run("evaluate " + arguments);
    EXPECT_EQ(result.exitCode, exitCode) << arguments;
    return result.err;
  };
  EXPECT_EQ(message("pair.g2o edges.g2o", 3), "edges.g2o: vertex 0 has no estimate, so the trajectory is not known\n");
  EXPECT_EQ(message("points.g2o pair.g2o", 3).rfind("points.g2o: the graph has no poses", 0), 0u);
  EXPECT_EQ(message("pair.g2o three.txt", 3).rfind("pair.g2o against three.txt: the trajectories have 2 and 3", 0), 0u);
  EXPECT_EQ(message("pair.g2o pair.g2o --match stamp", 3).rfind("pair.g2o against pair.g2o: ", 0), 0u);
  EXPECT_EQ(message("pair.g2o pair.g2o --max-difference 1", 2),
            "--max-difference is of time stamps, and these poses are matched by id\n");
}

TEST_F(EvaluateCommand, ReadsGraphsAsTheOtherCommandsDo) {
  write("truth.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n");
  write("odd.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nODD 1 2 3\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 -1\n");
  EXPECT_EQ(run("evaluate odd.g2o truth.g2o").exitCode, 3);
  const CommandResult result = run("evaluate odd.g2o truth.g2o --unknown skip --information clamp");
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_NE(result.err.find("odd.g2o: 1 line of unknown tag 'ODD' skipped"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace quiver::test
