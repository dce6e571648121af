#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

/// Edges of a long way, whose vertices have no estimates.
std::string chainOf(int edges) {
  std::string text;
  for (int i = 0; i < edges; ++i) text += fmt::format("EDGE_SE2 {} {} 1 0 0.1 100 0 0 100 0 400\n", i, i + 1);
  return text;
}

class AlgorithmFlags : public CommandTest {};

TEST_F(AlgorithmFlags, EverySolverNameOfG2oSetsAlgorithmAndSolver) {
  write("square.g2o", square);
  const double best = optimize("square.g2o --quiet")["final_chi2"];
  struct Expected {
    const char* name;
    const char* algorithm;
    const char* solver;
  };
  for (const auto& [name, algorithm, solver] : {Expected{"gn_var", "gn", "block"},
                                                {"lm_var", "lm", "block"},
                                                {"dl_var", "dogleg", "block"},
                                                {"lm_fix6_3_csparse", "lm", "block"},
                                                {"gn_dense", "gn", "dense"},
                                                {"lm_dense6_3", "lm", "dense"},
                                                {"lm_pcg", "lm", "pcg"},
                                                {"gn_pcg3_2", "gn", "pcg"},
                                                {"2dlinear", "gn", "block"}}) {
    const Json report = optimize(fmt::format("square.g2o --quiet --algorithm {}", name));
    EXPECT_EQ(report["algorithm"], algorithm) << name;
    EXPECT_EQ(report["linear_solver"], solver) << name;
    EXPECT_NEAR(report["final_chi2"].get<double>(), best, 1e-7 * best) << name;
  }
}

TEST_F(AlgorithmFlags, ListShowsTheNames) {
  EXPECT_THAT(run("list").out, HasSubstr("lm_var_cholmod       lm with cholmod"));
  EXPECT_EQ(run("list --json list.json").exitCode, 0);
  const Json names = Json::parse(read("list.json"))["solver_names"];
  // Nine names each of Eigen, CHOLMOD and CSparse, eight each of dense and PCG, three more.
  EXPECT_EQ(names.size(), 46u);
}

TEST_F(AlgorithmFlags, StopsEarlyInLongWork) {
  write("long.g2o", chainOf(400000));
  // The signal comes early in whatever takes longest: reading, the initial guess, or the descent.
  const CommandResult result = run("optimize long.g2o -o out.g2o & sleep 0.3; kill -INT $!; wait $!");
  EXPECT_EQ(result.exitCode, 5) << result.out << result.err;
  const CommandResult twice = run("optimize long.g2o -o out.g2o & sleep 0.3; kill -INT $!; kill -INT $!; wait $!");
  // Both may arrive before the handler has seen the first; then they count as one.
  EXPECT_TRUE(twice.exitCode == 130 || twice.exitCode == 5) << twice.exitCode;
}

TEST_F(AlgorithmFlags, AHangupStopsWhatDoesNotIgnoreIt) {
  write("long.g2o", chainOf(400000));
  EXPECT_EQ(run("optimize long.g2o & sleep 0.3; kill -HUP $!; wait $!").exitCode, 5);
  // As nohup starts it.
  write("shorter.g2o", chainOf(100000));
  const std::string ignoring =
      fmt::format("--version; trap '' HUP; '{}' optimize shorter.g2o -o out.g2o & sleep 0.3; kill -HUP $!; wait $!",
                  QUIVER_COMMAND);
  EXPECT_EQ(run(ignoring).exitCode, 0);
  EXPECT_TRUE(exists("out.g2o"));
}

TEST_F(AlgorithmFlags, ASecondSignalLeavesWhatIsBeingSaved) {
  write("long.g2o", chainOf(150000));
  // Signals come once part of the output is there; should it be complete by then, they come too late and change
  // nothing.
  const CommandResult result =
      run("optimize long.g2o -o out.g2o.gz --time-limit 0 & for i in $(seq 6000); do "
          "test -n \"$(find . -name '.quiver-*' -size +0)\" && break; sleep 0.01; done; "
          "kill -TERM $!; sleep 0.02; kill -TERM $!; wait $!");
  EXPECT_EQ(result.exitCode, 5) << result.err;
  EXPECT_TRUE(exists("out.g2o.gz"));
  for (const auto& entry : std::filesystem::directory_iterator(folder()))
    EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
}

TEST_F(AlgorithmFlags, IterativeSolversEndEarlierWhereLessIsAsked) {
  ASSERT_EQ(run("simulate bundle -o in.bal --cameras 30 --points 600").exitCode, 0);
  for (const std::string solver : {"pcg", "power"}) {
    const auto products = [&](const std::string& more) {
      const Json report = optimize("in.bal --iterations 3 --solver " + solver + more);
      int sum = 0;
      for (const Json& iteration : report["iterations"]) sum += iteration["linear_iterations"].get<int>();
      return sum;
    };
    EXPECT_LT(products(" --linear-tolerance 0.9"), products("")) << solver;
  }
}

TEST_F(AlgorithmFlags, NamesThatContradictOrDoNotExistAreRefused) {
  write("square.g2o", square);
  EXPECT_EQ(run("optimize square.g2o --algorithm lm_var --solver dense").exitCode, 2);
  const CommandResult unknown = run("optimize square.g2o --algorithm lm_vra");
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'lm_var'"));
  EXPECT_EQ(run("optimize square.g2o --algorithm structure_only_3").exitCode, 0);
  EXPECT_EQ(run("optimize square.g2o --algorithm structure_only_2").exitCode, 3) << "nothing has two dimensions";
}

TEST_F(AlgorithmFlags, PcgReportsItsIterations) {
  EXPECT_EQ(run("simulate sphere -o sphere.g2o --laps 10 --nodes-per-lap 20").exitCode, 0);
  const Json direct = optimize("sphere.g2o --quiet --solver block");
  const Json iterative = optimize("sphere.g2o --quiet --solver pcg");
  EXPECT_EQ(iterative["status"], "converged");
  EXPECT_NEAR(iterative["final_chi2"].get<double>(), direct["final_chi2"].get<double>(),
              1e-6 * direct["final_chi2"].get<double>());
  EXPECT_GT(iterative["iterations"][0]["linear_iterations"].get<int>(), 1);
  EXPECT_EQ(direct["iterations"][0]["linear_iterations"], 0);
}

/// One pose with a unary measurement far off beside a good one: the cost tells the kernel and its width.
constexpr const char* pair =
    "VERTEX_SE2 0 0 0 0\nFIX 0\nVERTEX_SE2 1 0 0 0\nVERTEX_SE2 2 0 0 0\n"
    "EDGE_SE2 0 1 3 0 0 1 0 0 1 0 1\nEDGE_SE2 0 2 4 0 0 1 0 0 1 0 1\n";

TEST_F(AlgorithmFlags, WidthsFollowFromAProbability) {
  write("pair.g2o", pair);
  const double squared = 7.814727903251179;  // 95 % of a squared error of three dimensions
  const double width = std::sqrt(squared);
  EXPECT_NEAR(
      optimize("pair.g2o --quiet --init file --iterations 0 --robust huber:p0.95")["initial_cost"].get<double>(),
      2.0 * width * 3.0 - squared + 2.0 * width * 4.0 - squared, 1e-9);
  EXPECT_NEAR(
      optimize("pair.g2o --quiet --init file --iterations 0 --robust gemanmcclure:p0.95")["initial_cost"].get<double>(),
      9.0 * squared / (squared + 9.0) + 16.0 * squared / (squared + 16.0), 1e-9);
  for (const char* wrong : {"huber:p", "huber:p0", "huber:p1", "huber:p1.5", "huber:px", "huber:p0.9:2"})
    EXPECT_EQ(run(fmt::format("optimize pair.g2o --robust {}", wrong)).exitCode, 2) << wrong;
}

TEST_F(AlgorithmFlags, KernelsGoOnTheEdgesChosen) {
  write("pair.g2o", pair);
  const auto cost = [&](const std::string& flags) {
    return optimize("pair.g2o --quiet --init file --iterations 0 --robust huber:1 " + flags)["initial_cost"]
        .get<double>();
  };
  EXPECT_NEAR(cost(""), (6.0 - 1.0) + (8.0 - 1.0), 1e-12);
  EXPECT_NEAR(cost("--robust-edges all"), (6.0 - 1.0) + (8.0 - 1.0), 1e-12);
  EXPECT_NEAR(cost("--robust-edges loops"), 9.0 + (8.0 - 1.0), 1e-12) << "0-1 is odometry, 0-2 is not";
  EXPECT_NEAR(cost("--robust-edges EDGE_SE2"), (6.0 - 1.0) + (8.0 - 1.0), 1e-12);
  EXPECT_EQ(run("optimize pair.g2o --robust huber --robust-edges EDGE_SE").exitCode, 2);
  EXPECT_EQ(run("optimize pair.g2o --robust huber --robust-edges loops,EDGE_SE2").exitCode, 2);
  EXPECT_EQ(run("optimize pair.g2o --robust-edges loops").exitCode, 2) << "no kernel is named";
}

TEST_F(AlgorithmFlags, KernelsForEdgesThatAreNotThereAreRefused) {
  write("pair.g2o", pair);
  for (const char* edges : {"EDGE_SE2_XY", "EDGE_SE2,EDGE_SE2_XY"}) {
    const CommandResult result = run(fmt::format("optimize pair.g2o -o x.g2o --robust huber --robust-edges {}", edges));
    EXPECT_EQ(result.exitCode, 3) << edges;
    EXPECT_THAT(result.err, HasSubstr("pair.g2o: --robust-edges EDGE_SE2_XY: the graph has no edge of the type "
                                      "EDGE_SE2_XY; it has 2 EDGE_SE2"));
    EXPECT_FALSE(exists("x.g2o"));
  }
  write("chain.g2o", "VERTEX_SE2 0 0 0 0\nFIX 0\nVERTEX_SE2 1 0 0 0\nEDGE_SE2 0 1 3 0 0 1 0 0 1 0 1\n");
  const CommandResult chain = run("optimize chain.g2o --robust huber --robust-edges loops");
  EXPECT_EQ(chain.exitCode, 0) << "most graphs of a survey may have loops";
  EXPECT_THAT(chain.out, HasSubstr("no edge of the graph closes a loop, so --robust changes nothing"));
  EXPECT_THAT(run("optimize pair.g2o --eliminate VERTEX_XY").out,
              HasSubstr("--eliminate VERTEX_XY: the graph has no vertex of the type VERTEX_XY; it has 3 VERTEX_SE2"));
}

TEST_F(AlgorithmFlags, SecondTagsNameEdgesToo) {
  // The point ψ = (0, 0, 1/2) in the anchor 2 is seen by 1 at the centre of its image, three pixels from the measured.
  write("psi.g2o",
        "PARAMS_CAMERAPARAMETERS 0 100 0 0 0\nVERTEX_XYZ 0 0 0 0.5\nVERTEX_SE3:EXPMAP 1 0 0 0 0 0 0 1\n"
        "VERTEX_SE3:EXPMAP 2 0 0 0 0 0 0 1\nFIX 1 2\nEDGE_PROJECT_PSI2UV 0 1 2 0 3 0 1 0 1\n");
  for (const char* tag : {"EDGE_PROJECT_PSI2UV", "EDGE_PROJECT_PSI2UV:EXPMAP"}) {
    const Json report =
        optimize(fmt::format("psi.g2o --quiet --init file --iterations 0 --robust huber:1 --robust-edges {}", tag));
    EXPECT_NEAR(report["initial_chi2"].get<double>(), 9.0, 1e-9);
    EXPECT_NEAR(report["initial_cost"].get<double>(), 6.0 - 1.0, 1e-9) << tag;
  }
}

TEST_F(AlgorithmFlags, BothCorrectionsReachOneOptimum) {
  write("square.g2o", square);
  const Json first = optimize("square.g2o --quiet --robust cauchy:0.5");
  const Json second = optimize("square.g2o --quiet --robust cauchy:0.5 --robust-correction second");
  EXPECT_NEAR(first["final_cost"].get<double>(), second["final_cost"].get<double>(),
              1e-7 * first["final_cost"].get<double>());
  EXPECT_EQ(run("optimize square.g2o --robust-correction third").exitCode, 2);
}

}  // namespace
}  // namespace quiver::test
