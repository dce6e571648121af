#include <cmath>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class InfoCommand : public CommandTest {
 protected:
  Json info(const std::string& arguments) const { return Json::parse(run("info " + arguments + " --json -").out); }
};

std::string pose(int id, double x) { return "VERTEX_SE2 " + std::to_string(id) + " " + std::to_string(x) + " 0 0\n"; }
std::string step(int from, int to, const std::string& measured) {
  return "EDGE_SE2 " + std::to_string(from) + " " + std::to_string(to) + " " + measured + " 1 0 0 1 0 1\n";
}

TEST_F(InfoCommand, FindsBridges) {
  // A triangle 0 1 2, a bridge to the chain 3 4, twice joined to 5; and two poses apart.
  std::string text;
  for (int i = 0; i < 8; ++i) text += pose(i, i);
  text += step(0, 1, "1 0 0") + step(1, 2, "1 0 0") + step(0, 2, "2 0 0") + step(2, 3, "1 0 0") + step(3, 4, "1 0 0") +
          step(4, 5, "1 0 0") + step(5, 4, "-1 0 0") + step(6, 7, "1 0 0");
  write("in.g2o", text);
  const Json json = info("in.g2o");
  EXPECT_EQ(json["components"], 2);
  EXPECT_EQ(json["independent_cycles"], 2);
  ASSERT_EQ(json["bridges"].size(), 3u);
  EXPECT_EQ(json["bridges"][0], (Json{{"type", "EDGE_SE2"}, {"vertices", {2, 3}}, {"cut_off", 3}}));
  EXPECT_EQ(json["bridges"][1], (Json{{"type", "EDGE_SE2"}, {"vertices", {3, 4}}, {"cut_off", 2}}));
  EXPECT_EQ(json["bridges"][2], (Json{{"type", "EDGE_SE2"}, {"vertices", {6, 7}}, {"cut_off", 1}}));
  EXPECT_NE(run("info in.g2o").out.find("3 edges without which a component falls apart; EDGE_SE2 2 3 cuts off 3 vert"),
            std::string::npos);
}

TEST_F(InfoCommand, AnEdgeOverManyVerticesIsOneBridge) {
  write("in.g2o",
        "VERTEX_SE2 0 0 0 0\nFIX 0\nVERTEX_XY 1 1 0\nVERTEX_XY 2 0 1\nVERTEX_XY 3 1 1\n"
        "EDGE_SE2_LOTSOFXY 0 1 2 || 2 1 0 0 1 1 0 0 0 1 0 0 1 0 1\nEDGE_POINTXY 2 3 1 0 1 0 1\n"
        "EDGE_POINTXY 1 2 -1 1 1 0 1\n");
  const Json json = info("in.g2o");
  // Without the edge over three, 0 is alone; 1 2 3 hold together.
  ASSERT_EQ(json["bridges"].size(), 2u);
  EXPECT_EQ(json["bridges"][0]["vertices"], Json({0, 1, 2}));
  EXPECT_EQ(json["bridges"][0]["cut_off"], 1);
  EXPECT_EQ(json["bridges"][1]["vertices"], Json({2, 3}));
  EXPECT_EQ(json["independent_cycles"], 1);
}

TEST_F(InfoCommand, NamesDirectionsThatNothingHolds) {
  // A landmark on the x axis that is seen once, by its direction; another from two sides; a pose by its place alone.
  write("in.g2o",
        "VERTEX_SE2 0 0 0 0\nFIX 0\nVERTEX_SE2 1 0 4 0\nFIX 1\nVERTEX_SE2 2 5 5 0\nVERTEX_XY 7 3 0\nVERTEX_XY 8 3 2\n"
        "EDGE_BEARING_SE2_XY 0 7 0 10\nEDGE_BEARING_SE2_XY 0 8 0.5880026035475675 10\n"
        "EDGE_BEARING_SE2_XY 1 8 -0.5880026035475675 10\nEDGE_PRIOR_SE2_XY 2 5 5 1 0 1\n");
  const Json json = info("in.g2o");
  ASSERT_EQ(json["unconstrained"].size(), 2u) << json["unconstrained"];
  EXPECT_EQ(json["unconstrained"][0], (Json{{"vertex", 2}, {"type", "VERTEX_SE2"}, {"directions", {"theta [rad]"}}}));
  EXPECT_EQ(json["unconstrained"][1], (Json{{"vertex", 7}, {"type", "VERTEX_XY"}, {"directions", {"x [m]"}}}));
  EXPECT_NE(run("info in.g2o").out.find("VERTEX_XY 7: x [m]"), std::string::npos);
}

TEST_F(InfoCommand, GatesAndProbabilitiesAreThoseOfTheChiSquareDistribution) {
  // chi2 of two degrees of freedom exceeds c with probability exp(−c/2).
  write("in.g2o",
        "VERTEX_SE2 0 0 0 0\nVERTEX_XY 1 3 0\nFIX 0 1\nEDGE_SE2_XY 0 1 1 0 1 0 1\nEDGE_SE2_XY 0 1 2 0 4 0 0\n");
  const Json json = info("in.g2o");
  EXPECT_NEAR(json["worst_edges"][0]["p_value"].get<double>(), std::exp(-2.0), 1e-12);
  EXPECT_EQ(json["worst_edges"][0]["dimension"], 2);
  EXPECT_EQ(json["worst_edges"][1]["dimension"], 1) << "y has no weight";
  EXPECT_NEAR(json["worst_edges"][1]["p_value"].get<double>(), std::erfc(2.0 / std::sqrt(2.0)), 1e-12);
  EXPECT_EQ(json["redundancy"]["measured"], 3);
  EXPECT_EQ(json["redundancy"]["determined"], 0);
  EXPECT_EQ(json["gates"][0], (Json{{"probability", 0.95}, {"beyond", 1}, {"expected", 2 * (1.0 - 0.95)}}));
}

TEST_F(InfoCommand, SuspectsAreTheWrongLoopClosures) {
  ASSERT_EQ(run("simulate manhattan -o a.g2o --truth t.g2o --poses 400 --seed 2").exitCode, 0);
  // At the truth every right measurement fits; two wrong ones do not.
  write("t2.g2o",
        read("t.g2o") + "EDGE_SE2 10 300 1 1 1 500 0 0 500 0 5000\nEDGE_SE2 20 200 3 1 2 500 0 0 500 0 5000\n");
  const Json wrong = info("t2.g2o");
  ASSERT_EQ(wrong["suspects"].size(), 2u);
  for (const Json& suspect : wrong["suspects"])
    EXPECT_TRUE(suspect["vertices"][0] == 10 || suspect["vertices"][0] == 20);
  const Json right = info("t.g2o");
  EXPECT_TRUE(right["suspects"].empty());
  EXPECT_TRUE(right["suspects_judged"].get<bool>());
  // 399 of 400 poses unknown.
  EXPECT_EQ(right["redundancy"]["determined"], 3 * 399);
  // Odometry fits no loop: nothing stands out.
  const Json far = info("a.g2o");
  EXPECT_FALSE(far["suspects_judged"].get<bool>());
  EXPECT_TRUE(far["suspects"].empty());
}

TEST_F(InfoCommand, AnEstimateMissingWhereNoEdgeIsHidesNothing) {
  const std::string two = pose(0, 0.0) + pose(1, 1.5) + step(0, 1, "1 0 0");
  write("complete.g2o", two);
  write("apart.g2o", two + "#quiver vertex VERTEX_SE2 9\n");
  write("missing.g2o", "#quiver vertex VERTEX_SE2 9\n" + two + step(1, 9, "1 0 0"));
  const Json complete = info("complete.g2o"), apart = info("apart.g2o"), missing = info("missing.g2o");
  EXPECT_EQ(apart["without_estimate"], Json({9}));
  for (const auto& [key, value] : complete.items()) {
    EXPECT_TRUE(apart.contains(key)) << key;
    EXPECT_TRUE(missing.contains(key)) << key;
  }
  EXPECT_EQ(apart["chi2"], complete["chi2"]);
  EXPECT_EQ(apart["redundancy"], complete["redundancy"]);
  EXPECT_EQ(apart["gauge"], complete["gauge"]);
  EXPECT_TRUE(missing["chi2"].is_null());
  EXPECT_TRUE(missing["redundancy"]["measured"].is_null());
  EXPECT_NE(run("info missing.g2o").out.find("unknown: vertices have no estimate"), std::string::npos);
}

TEST_F(InfoCommand, SaysWhichLevelIsCounted) {
  const std::string two = pose(0, 0.0) + pose(1, 1.5) + step(0, 1, "1 0 0");
  write("one.g2o", two);
  write("levels.g2o", two + step(0, 1, "2 0 0") + "#quiver level 1\n");
  EXPECT_EQ(run("info one.g2o").out.find("of level 0 alone"), std::string::npos);
  EXPECT_NE(run("info levels.g2o").out.find("cost 0.25, of the edges of level 0 alone"), std::string::npos);
}

TEST_F(InfoCommand, DrawsMatricesBeforeAndAfterOrdering) {
  ASSERT_EQ(run("simulate manhattan -o a.g2o --poses 300").exitCode, 0);
  const CommandResult drawn = run("plot a.g2o --structure -o s.svg");
  ASSERT_EQ(drawn.exitCode, 0) << drawn.err;
  EXPECT_NE(drawn.out.find("H: 299 blocks"), std::string::npos) << drawn.out;
  EXPECT_NE(drawn.out.find("the same, ordered ("), std::string::npos) << drawn.out;
  EXPECT_NE(drawn.out.find("its Cholesky factor: 299 blocks"), std::string::npos) << drawn.out;
  EXPECT_NE(read("s.svg").find("the same, ordered"), std::string::npos);
}

}  // namespace
}  // namespace quiver::test
