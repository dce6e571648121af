// quiver check: the promises of types, of plugins and built in.
#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class CheckCommand : public CommandTest {
 protected:
  static constexpr const char* beacons = "'" QUIVER_TEST_BEACONS "'";
  static constexpr const char* broken = "'" QUIVER_TEST_BROKEN "'";
};

TEST_F(CheckCommand, PassesAPluginThatKeepsItsPromises) {
  const CommandResult result = run(std::string("check ") + beacons);
  EXPECT_EQ(result.exitCode, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("EDGE_RANGE_SE2_XY: chi2 stays when the world moves in"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("2 types and 0 robust kernels, "), std::string::npos) << result.out;
  const Json json = Json::parse(run(std::string("check --json - ") + beacons).out);
  EXPECT_EQ(json["types"], Json::array({"VERTEX_BEACON", "EDGE_RANGE_SE2_XY"}));
  EXPECT_TRUE(json["passed"]);
  EXPECT_GT(json["checks"], 50);
}

TEST_F(CheckCommand, FindsWhatAPluginBreaks) {
  const CommandResult result = run(std::string("check --json report.json ") + broken);
  EXPECT_EQ(result.exitCode, 3);
  const Json json = Json::parse(read("report.json"));
  EXPECT_FALSE(json["passed"]);
  ASSERT_EQ(json["findings"].size(), 3u) << json;
  EXPECT_EQ(json["findings"][0]["name"], "EDGE_ABSCISSA");
  EXPECT_EQ(json["findings"][0]["check"], "jacobians");
  EXPECT_EQ(json["findings"][1]["name"], "EDGE_THROWING");
  EXPECT_EQ(json["findings"][2]["name"], "Lopsided");
  EXPECT_NE(result.out.find("Lopsided: robust kernel: "), std::string::npos) << result.out;
}

TEST_F(CheckCommand, WhatAPluginThrowsIsItsOwn) {
  write("in.g2o", "VERTEX_SE2 0 0 0 0\nEDGE_THROWING 0 1 1\n");
  const CommandResult standard = run(std::string("optimize in.g2o --plugin ") + broken);
  EXPECT_EQ(standard.exitCode, 3) << standard.err;
  EXPECT_NE(standard.err.find("a function of a plugin threw: no error today"), std::string::npos) << standard.err;
  write("in.g2o", "VERTEX_SE2 0 0 0 0\nEDGE_THROWING 0 -1 1\n");
  const CommandResult other = run(std::string("info in.g2o --plugin ") + broken);
  EXPECT_EQ(other.exitCode, 3) << other.err;
  EXPECT_NE(other.err.find("what is no exception of the standard"), std::string::npos) << other.err;
}

TEST_F(CheckCommand, ChecksChosenBuiltinTypes) {
  const CommandResult result = run("check --builtin --types EDGE_SE2,VERTEX_SE2 --draws 5 --seed 3");
  EXPECT_EQ(result.exitCode, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("2 types and 0 robust kernels, "), std::string::npos) << result.out;
  const Json json = Json::parse(run("check --builtin --types EDGE_SE2 --json -").out);
  // A pose in the plane has no part in the other moves of space.
  EXPECT_EQ(json["world_invariance"]["EDGE_SE2"], Json::array({"x", "y", "z", "roll", "pitch", "yaw"})) << json;
}

TEST_F(CheckCommand, SaysWhatIsWrongWithItsArguments) {
  EXPECT_EQ(run("check").exitCode, 2);
  EXPECT_EQ(run("check missing.so").exitCode, 3);
  const CommandResult unknown = run("check --builtin --types EDGE_NONE");
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_NE(unknown.err.find("there is no type 'EDGE_NONE'"), std::string::npos) << unknown.err;
  EXPECT_EQ(run("check --builtin --types EDGE_SE2 --json missing/folder.json").exitCode, 6);
}

}  // namespace
}  // namespace quiver::test
