#include <cmath>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class OtherCommands : public CommandTest {};

TEST_F(OtherCommands, TellVersionAndHelp) {
  EXPECT_EQ(run("--version").out.rfind("quiver ", 0), 0u);
  EXPECT_EQ(run("--help").exitCode, 0);
  for (const char* command : {"optimize", "info", "list", "convert", "simulate", "plot", "evaluate", "check"}) {
    const CommandResult help = run(std::string(command) + " --help");
    EXPECT_EQ(help.exitCode, 0) << command;
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
  }
}

TEST_F(OtherCommands, SimulateIsSeededAndComesWithTheTruth) {
  ASSERT_EQ(run("simulate sphere -o a.g2o --truth t.g2o --laps 6 --nodes-per-lap 10 --seed 5").exitCode, 0);
  ASSERT_EQ(run("simulate sphere -o b.g2o --laps 6 --nodes-per-lap 10 --seed 5").exitCode, 0);
  ASSERT_EQ(run("simulate sphere -o c.g2o --laps 6 --nodes-per-lap 10 --seed 6").exitCode, 0);
  EXPECT_EQ(read("a.g2o"), read("b.g2o"));
  EXPECT_NE(read("a.g2o"), read("c.g2o"));
  const Json noisy = Json::parse(run("info a.g2o --json -").out);
  EXPECT_EQ(noisy["input"]["vertices"]["VERTEX_SE3:QUAT"], 60);
  // 59 steps and three closures a pose of the first five laps, but for the one past the end.
  EXPECT_EQ(noisy["input"]["edges"]["EDGE_SE3:QUAT"], 59 + 149);
  EXPECT_EQ(noisy["components"], 1);
  EXPECT_EQ(noisy["fixed"], 1);
  // At the truth chi2 has 6 degrees of freedom a measurement; five deviations of its own spread are allowed.
  const Json truth = Json::parse(run("info t.g2o --json -").out);
  EXPECT_NEAR(truth["chi2"].get<double>(), 6.0 * 208, 5.0 * std::sqrt(2.0 * 6.0 * 208));
  EXPECT_EQ(run("simulate sphere -o a.g2o --noise-rotation '0.1;0.2'").exitCode, 2);
}

TEST_F(OtherCommands, SimulatedPosesSurviveReadingToTheLastBit) {
  ASSERT_EQ(run("simulate sphere -o a.g2o --laps 20 --nodes-per-lap 50").exitCode, 0);
  ASSERT_EQ(run("convert a.g2o b.g2o").exitCode, 0);
  EXPECT_EQ(read("a.g2o"), read("b.g2o"));
}

TEST_F(OtherCommands, SimulatedNoiseHasTheStatedSize) {
  ASSERT_EQ(run("simulate sphere -o a.g2o --truth t.g2o --laps 10 --nodes-per-lap 20 --noise-rotation 0.05 "
                "--noise-translation '0.1;0.2;0.3'")
                .exitCode,
            0);
  const Json truth = Json::parse(run("info t.g2o --json -").out);
  const double freedom = 6.0 * truth["input"]["edges"]["EDGE_SE3:QUAT"].get<double>();
  EXPECT_NEAR(truth["chi2"].get<double>(), freedom, 5.0 * std::sqrt(2.0 * freedom));
}

TEST_F(OtherCommands, OneIsNoPlural) {
  EXPECT_NE(run("simulate sphere -o a.g2o --laps 1 --nodes-per-lap 3").out.find("a sphere of 3 poses in 1 lap and "),
            std::string::npos);
  write("one.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  EXPECT_NE(run("optimize one.g2o --init tree").out.find(" tells 1 vertex, "), std::string::npos);
  write("pair.g2o",
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n"
        "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  const std::string told = run("info pair.g2o").out;
  EXPECT_NE(told.find("1 independent one\n"), std::string::npos) << told;
  EXPECT_NE(told.find("1 edge joins the same vertices as another one"), std::string::npos) << told;
}

TEST_F(OtherCommands, InfoTellsOfTrouble) {
  write("in.g2o", std::string(square) +
                      "VERTEX_SE2 9 0 0 0\nVERTEX_SE2 20 0 0 0\nVERTEX_SE2 21 1 0 0\n"
                      "EDGE_SE2 20 21 1 0 0 0 0 0 0 0 0\nEDGE_SE2 0 1 1 0 1.57 1 0 0 1 0 1\n");
  const Json info = Json::parse(run("info in.g2o --plan --json -").out);
  EXPECT_EQ(info["components"], 2);
  EXPECT_EQ(info["isolated"], Json::array({9}));
  EXPECT_EQ(info["zero_information"], Json::array({"EDGE_SE2 20 21"}));
  EXPECT_EQ(info["parallel_edges"], 1);
  EXPECT_EQ(info["worst_edges"].size(), 5u);
  EXPECT_GT(info["worst_edges"][0]["chi2"], info["worst_edges"][1]["chi2"]);
  EXPECT_TRUE(info["plan"].contains("linear_solver_reason"));
  EXPECT_NE(run("info in.g2o").out.find("zero weight"), std::string::npos);
}

TEST_F(OtherCommands, InfoAgreesWithOptimizeOnChi2) {
  write("in.g2o", square);
  const Json info = Json::parse(run("info in.g2o --json -").out);
  const Json report = optimize("in.g2o --init file --iterations 0");
  EXPECT_NEAR(info["chi2"].get<double>(), report["initial_chi2"].get<double>(), 1e-12 * info["chi2"].get<double>());
}

TEST_F(OtherCommands, InfoKnowsVerticesWithoutEstimate) {
  write("edges.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  const Json info = Json::parse(run("info edges.g2o --json -").out);
  EXPECT_EQ(info["without_estimate"], Json::array({0, 1}));
  EXPECT_TRUE(info["chi2"].is_null());
  EXPECT_EQ(run("info edges.g2o --plan").exitCode, 0);
  write("psi.g2o", "PARAMS_CAMERAPARAMETERS 0 100 0 0 0\nEDGE_PROJECT_PSI2UV:EXPMAP 0 1 2 0 25 0 1 0 1\n");
  const CommandResult unknown = run("info psi.g2o --plan");
  EXPECT_EQ(unknown.exitCode, 3);
  EXPECT_EQ(unknown.err.rfind("psi.g2o: no edge tells where vertex 0", 0), 0u) << unknown.err;
}

TEST_F(OtherCommands, ListDescribesTypesAndNames) {
  const Json list = Json::parse(run("list --json -").out);
  bool found = false;
  for (const Json& type : list["edges"]) {
    if (type["tag"] != "EDGE_SE2") continue;
    found = true;
    EXPECT_EQ(type["vertices"], Json::array({"VERTEX_SE2", "VERTEX_SE2"}));
    EXPECT_EQ(type["fields"].size(), 3u);
    EXPECT_EQ(type["jacobians"], "analytic");
    EXPECT_FALSE(type["documentation"].get<std::string>().empty());
  }
  EXPECT_TRUE(found);
  EXPECT_NE(run("list").out.find("VERTEX_SE3:QUAT"), std::string::npos);
}

TEST_F(OtherCommands, ConvertCompressesAndComesBack) {
  write("in.g2o", square);
  ASSERT_EQ(run("convert in.g2o a.g2o").exitCode, 0);
  ASSERT_EQ(run("convert a.g2o b.g2o.gz").exitCode, 0);
  ASSERT_EQ(run("convert b.g2o.gz c.g2o.bz2").exitCode, 0);
  ASSERT_EQ(run("convert c.g2o.bz2 d.g2o").exitCode, 0);
  EXPECT_EQ(read("a.g2o"), read("d.g2o"));
  EXPECT_NE(read("b.g2o.gz"), read("a.g2o"));
  EXPECT_EQ(run("convert in.g2o no/such/folder/x.g2o").exitCode, 6);
}

TEST_F(OtherCommands, ConvertGoesBetweenFormats) {
  ASSERT_EQ(run("simulate sphere -o a.g2o --laps 4 --nodes-per-lap 8").exitCode, 0);
  ASSERT_EQ(run("convert a.g2o a.graph.gz").exitCode, 0);
  const Json toro = Json::parse(run("info a.graph.gz --json -").out);
  EXPECT_EQ(toro["input"]["format"], "toro");
  EXPECT_EQ(toro["input"]["vertices"]["VERTEX3"], 32);
  ASSERT_EQ(run("convert a.graph.gz b.csv").exitCode, 0);
  const Json table = Json::parse(run("info b.csv --json -").out);
  EXPECT_EQ(table["input"]["format"], "csv");
  EXPECT_EQ(table["input"]["vertices"]["VERTEX_SE3:QUAT"], 32);
  const double chi2 = Json::parse(run("info a.g2o --json -").out)["chi2"].get<double>();
  EXPECT_NEAR(toro["chi2"].get<double>(), chi2, 1e-9 * chi2);
  EXPECT_NEAR(table["chi2"].get<double>(), chi2, 1e-9 * chi2);
  // Through pipes, and back to the same bytes.
  ASSERT_EQ(run("convert a.g2o - --to csv > p.csv").exitCode, 0);
  ASSERT_EQ(run("convert - c.g2o < p.csv").exitCode, 0);
  EXPECT_EQ(read("c.g2o"), read("a.g2o"));
  ASSERT_EQ(run("optimize a.g2o -o o.toro --quiet").exitCode, 0);
  EXPECT_EQ(read("o.toro").rfind("VERTEX3 0 ", 0), 0u);
}

TEST_F(OtherCommands, FormatsThatCannotHoldAGraphAreRefused) {
  write("plane.g2o", "VERTEX_PLANE 0 0 0 1 -1 0 0 0\n");
  for (const char* command :
       {"convert plane.g2o x.graph", "convert plane.g2o - --to toro", "optimize plane.g2o -o x.toro"}) {
    const CommandResult refused = run(command);
    EXPECT_EQ(refused.exitCode, 6) << command;
    EXPECT_NE(refused.err.find("TORO files have no VERTEX_PLANE"), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(exists("x.graph"));
  EXPECT_EQ(run("simulate manhattan -o x.csv --poses 10").exitCode, 2);
  EXPECT_EQ(run("convert plane.g2o x.g2o --to xml").exitCode, 2);
}

TEST_F(OtherCommands, SimulateRefusesWhatMakesNoSense) {
  ASSERT_EQ(run("simulate sphere -o s.g2o --laps 4 --nodes-per-lap 8").exitCode, 0);
  struct Wrong {
    const char* words;
    int exitCode;
    const char* message;
  };
  for (const auto& [words, exitCode, message] :
       {Wrong{"sphere -o x.g2o --seed -1", 2, "--seed: '-1' is no whole number of at least 0"},
        Wrong{"manhattan -o x.g2o --seed -1", 2, "--seed: '-1' is no whole number of at least 0"},
        Wrong{"bundle -o x.g2o --seed -1", 2, "--seed: '-1' is no whole number of at least 0"},
        Wrong{"bundle -o x.g2o --threads -4", 2, "--threads: '-4' is no whole number from 0 to 4096"},
        Wrong{"sphere -o x.g2o --noise-rotation '0.1;;0.1'", 2, "in the list '0.1;;0.1' a word is missing at a ';'"},
        Wrong{"manhattan -o x.g2o --sensors odometry,,pose", 2, "in the list 'odometry,,pose' a word is missing"},
        Wrong{"manhattan -o x.g2o --sensors radar", 2, "--sensors: 'radar' is none of odometry, pose, compass, gps"},
        Wrong{"sphere -o x.bal", 6, "x.bal: a bundle adjustment file (.bal) cannot hold vertex 0"},
        Wrong{"sphere -o x.g2o --truth x.bal", 6, "x.bal: a bundle adjustment file (.bal) cannot hold vertex 0"},
        Wrong{"outliers s.g2o -o x.bal", 6, "x.bal: a bundle adjustment file (.bal) cannot hold vertex 0"},
        Wrong{"sphere -o ''", 2, "the path of the file to write is empty"},
        Wrong{"manhattan -o ''", 2, "the path of the file to write is empty"},
        Wrong{"bundle -o ''", 2, "the path of the file to write is empty"}}) {
    const CommandResult result = run(std::string("simulate ") + words);
    EXPECT_EQ(result.exitCode, exitCode) << words;
    EXPECT_NE(result.err.find(message), std::string::npos) << words << '\n' << result.err;
    EXPECT_FALSE(exists("x.g2o")) << words;
  }
  write("pair.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  const CommandResult none = run("simulate outliers pair.g2o -o x.g2o");
  EXPECT_EQ(none.exitCode, 3);
  EXPECT_EQ(none.err.rfind("pair.g2o: no wrong loop closure to add", 0), 0u) << none.err;
}

TEST_F(OtherCommands, OutputsDoNotMix) {
  EXPECT_EQ(run("list --markdown --json -").exitCode, 2);
  EXPECT_EQ(run("list --markdown --json list.json").exitCode, 0);
  write("in.g2o", square);
  EXPECT_EQ(run("convert in.g2o ''").exitCode, 2);
}

TEST_F(OtherCommands, PlotDrawsPlanesAndSpace) {
  ASSERT_EQ(run("simulate sphere -o in.g2o --laps 6 --nodes-per-lap 12").exitCode, 0);
  ASSERT_EQ(run("optimize in.g2o -o out.g2o --quiet").exitCode, 0);
  ASSERT_EQ(run("plot out.g2o --before in.g2o -o both.svg").exitCode, 0);
  const std::string both = read("both.svg");
  EXPECT_EQ(both.rfind("<svg ", 0), 0u);
  EXPECT_NE(both.find("before: in.g2o"), std::string::npos);
  EXPECT_NE(both.find("after: out.g2o"), std::string::npos);
  EXPECT_NE(both.find("72 poses"), std::string::npos);
  EXPECT_EQ(both.find("nan"), std::string::npos);
  EXPECT_EQ(both.find("http", both.find("w3.org")), std::string::npos) << "self-contained";
  write("square.g2o", square);
  EXPECT_EQ(run("plot square.g2o -o -").out.rfind("<svg ", 0), 0u);
}

}  // namespace
}  // namespace quiver::test
