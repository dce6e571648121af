#include <cmath>
#include <map>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

struct World {
  const char* name;
  const char* arguments;
};
void PrintTo(const World& world, std::ostream* out) { *out << world.name; }

class SimulatedWorld : public CommandTest, public testing::WithParamInterface<World> {};

/// Measured scalars of all edges: the degrees of freedom of chi2 at the truth.
double freedomOf(const Json& edges) {
  const std::map<std::string, int> dimensions{{"EDGE_SE2", 3},
                                              {"EDGE_SE3:QUAT", 6},
                                              {"EDGE_SE2_XY", 2},
                                              {"EDGE_BEARING_SE2_XY", 1},
                                              {"EDGE_PRIOR_SE2_XY", 2},
                                              {"EDGE_PRIOR_SE2", 1},
                                              {"EDGE_SE3_TRACKXYZ", 3},
                                              {"EDGE_PROJECT_DEPTH", 3},
                                              {"EDGE_PROJECT_DISPARITY", 3},
                                              {"EDGE_SE3_XYZ_PRIOR", 3},
                                              {"EDGE_SE3_PRIOR", 3}};
  double freedom = 0.0;
  for (const auto& [tag, count] : edges.items()) freedom += dimensions.at(tag) * count.get<double>();
  return freedom;
}

TEST_P(SimulatedWorld, HasTheStatedNoiseAndFindsTheTruth) {
  const std::string arguments = GetParam().arguments;
  const CommandResult made = run("simulate " + arguments + " -o a.g2o --truth t.g2o --seed 3");
  ASSERT_EQ(made.exitCode, 0) << made.err;
  ASSERT_EQ(run("simulate " + arguments + " -o b.g2o --seed 3").exitCode, 0);
  EXPECT_EQ(read("a.g2o"), read("b.g2o"));
  ASSERT_EQ(run("simulate " + arguments + " -o c.g2o --seed 4").exitCode, 0);
  EXPECT_NE(read("a.g2o"), read("c.g2o"));
  const Json truth = Json::parse(run("info t.g2o --json -").out);
  const double freedom = freedomOf(truth["input"]["edges"]);
  EXPECT_EQ(truth["components"], 1);
  EXPECT_NEAR(truth["chi2"].get<double>(), freedom, 5.0 * std::sqrt(2.0 * freedom));
  // The optimum fits better than the truth, and lies nearer to it than odometry does.
  ASSERT_EQ(run("optimize a.g2o -o o.g2o --quiet").exitCode, 0);
  const Json best = Json::parse(run("info o.g2o --json -").out);
  EXPECT_LT(best["chi2"].get<double>(), truth["chi2"].get<double>());
  const Json before = Json::parse(run("evaluate a.g2o t.g2o --align none --json -").out);
  const Json after = Json::parse(run("evaluate o.g2o t.g2o --align none --json -").out);
  EXPECT_LT(after["absolute"]["translation_m"]["rmse"].get<double>(),
            before["absolute"]["translation_m"]["rmse"].get<double>());
}

INSTANTIATE_TEST_SUITE_P(
    All, SimulatedWorld,
    testing::Values(World{"Manhattan", "manhattan --poses 600"}, World{"Grid", "grid --poses 400"},
                    World{"Compass", "manhattan --poses 400 --sensors odometry,compass"},
                    World{"Gps", "manhattan --poses 400 --sensors odometry,gps"},
                    World{"Points", "landmarks-2d --poses 400 --landmarks 60"},
                    World{"Bearings", "landmarks-2d --poses 400 --landmarks 60 --sensors odometry,point,bearing"},
                    World{"Space", "landmarks-3d --poses 300 --landmarks 150"},
                    // Few poses: cameras need odometry to place landmarks before them, not behind.
                    World{"Cameras", "landmarks-3d --poses 60 --landmarks 150 --sensors depth,disparity"},
                    World{"SpaceCompassGps", "landmarks-3d --poses 300 --landmarks 50 --sensors compass,gps,pose"}),
    [](const auto& info) { return std::string(info.param.name); });

class SimulatedWorldErrors : public CommandTest {};

TEST_F(SimulatedWorldErrors, RefuseWhatMakesNoSense) {
  EXPECT_EQ(run("simulate manhattan -o a.g2o --poses 1").exitCode, 2);
  EXPECT_EQ(run("simulate grid -o a.g2o --side 1").exitCode, 2);
  EXPECT_EQ(run("simulate manhattan -o a.g2o --sensors point").exitCode, 2);
  EXPECT_EQ(run("simulate manhattan -o no/a.g2o").exitCode, 6);
  EXPECT_EQ(run("simulate manhattan -o a.g2o --truth a.g2o").exitCode, 2);
}

}  // namespace
}  // namespace quiver::test
