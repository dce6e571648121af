#include <algorithm>
#include <random>
#include <sstream>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class OptimizeCommand : public CommandTest {};

void expectKeys(const Json& json, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(json.contains(key)) << key;
}

TEST_F(OptimizeCommand, ReportsEveryKeyOfTheContract) {
  write("in.g2o", square);
  const Json report = optimize("in.g2o -o out.g2o --init file");
  expectKeys(report, {"quiver",     "input",       "algorithm",    "linear_solver", "ordering",
                      "threads",    "elimination", "gauge",        "initial_guess", "status",
                      "reason",     "file_chi2",   "initial_chi2", "final_chi2",    "initial_cost",
                      "final_cost", "iterations",  "factor",       "seconds",       "peak_memory_bytes"});
  expectKeys(report["input"], {"file", "format", "bytes", "vertices", "edges"});
  EXPECT_EQ(report["input"]["vertices"]["VERTEX_SE2"], 4);
  EXPECT_EQ(report["input"]["edges"]["EDGE_SE2"], 4);
  expectKeys(report["elimination"], {"eliminated", "types", "reason"});
  expectKeys(report["gauge"], {"fixed", "free", "reason"});
  expectKeys(report["factor"], {"nonzeros", "flops", "gflops_per_second"});
  expectKeys(report["seconds"], {"load", "compile", "analyze", "optimize", "save", "total"});
  ASSERT_FALSE(report["iterations"].empty());
  expectKeys(report["iterations"][0],
             {"iteration", "chi2", "cost", "accepted", "damping", "linear_iterations", "seconds"});
  expectKeys(report["iterations"][0]["seconds"],
             {"linearize", "assemble", "eliminate", "factorize", "solve", "update", "evaluate", "total"});
  EXPECT_EQ(report["iterations"][0]["iteration"], 0);
  EXPECT_EQ(report["status"], "converged");
  EXPECT_LT(report["final_chi2"], report["initial_chi2"]);
  EXPECT_GT(report["peak_memory_bytes"], 0);
  EXPECT_TRUE(exists("out.g2o"));
}

TEST_F(OptimizeCommand, PrintsOneLineAnIterationUnlessQuiet) {
  write("in.g2o", square);
  const CommandResult loud = run("optimize in.g2o --json report.json");
  const Json report = Json::parse(read("report.json"));
  EXPECT_NE(loud.out.find("\n   0  "), std::string::npos) << loud.out;
  EXPECT_NE(loud.out.find("converged: "), std::string::npos);
  EXPECT_GE(std::count(loud.out.begin(), loud.out.end(), '\n'), static_cast<long>(report["iterations"].size()) + 2);
  const CommandResult quiet = run("optimize in.g2o --quiet");
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(OptimizeCommand, KeepsStandardOutputForDataAlone) {
  write("in.g2o", square);
  EXPECT_TRUE(Json::accept(run("optimize in.g2o --json -").out));
  const CommandResult graph = run("optimize in.g2o -o -");
  EXPECT_EQ(graph.out.rfind("VERTEX_SE2 0 ", 0), 0u) << graph.out;
  EXPECT_NE(graph.err.find("converged"), std::string::npos);
  EXPECT_EQ(run("optimize in.g2o -o - --json -").exitCode, 2);
}

TEST_F(OptimizeCommand, AnswersUsageErrorsWithTwo) {
  write("in.g2o", square);
  EXPECT_EQ(run("").exitCode, 2);
  EXPECT_EQ(run("optimize").exitCode, 2);
  EXPECT_EQ(run("optimize in.g2o --algorithm newton").exitCode, 2);
  EXPECT_EQ(run("optimize in.g2o --iterations -3").exitCode, 2);
  EXPECT_EQ(run("optimize in.g2o --robust huber:wide").exitCode, 2);
  EXPECT_EQ(run("optimize in.g2o --robust huber:-1").exitCode, 2);
  const CommandResult solver = run("optimize in.g2o --solver blok --quiet");
  EXPECT_EQ(solver.exitCode, 2);
  EXPECT_NE(solver.err.find("did you mean 'block'"), std::string::npos) << solver.err;
  const CommandResult command = run("optimise in.g2o");
  EXPECT_EQ(command.exitCode, 2);
  EXPECT_NE(command.err.find("did you mean 'optimize'"), std::string::npos) << command.err;
  const CommandResult flag = run("optimize in.g2o --algoritm gn");
  EXPECT_EQ(flag.exitCode, 2);
  EXPECT_NE(flag.err.find("did you mean '--algorithm'"), std::string::npos) << flag.err;
}

TEST_F(OptimizeCommand, AnswersBadInputWithThreeAndTheSourceLine) {
  EXPECT_EQ(run("optimize missing.g2o").exitCode, 3);
  write("in.g2o", "VERTEX_SE2 0 0 0 0\nEDGE_SE3 0 1 1 0 0\n");
  write("out.g2o", "old");
  const CommandResult result = run("optimize in.g2o -o out.g2o --quiet");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_EQ(result.err.rfind("in.g2o:2:1: ", 0), 0u) << result.err;
  EXPECT_EQ(read("out.g2o"), "old");
  EXPECT_EQ(run("optimize in.g2o --plugin missing.so").exitCode, 3);
  const CommandResult incomplete = run("list --plugin '" QUIVER_TEST_INCOMPLETE "'");
  EXPECT_EQ(incomplete.exitCode, 3);
  EXPECT_NE(incomplete.err.find("functionOfNoLibrary"), std::string::npos) << incomplete.err;
  write("square.g2o", square);
  EXPECT_EQ(run("optimize square.g2o --fix 77").exitCode, 3);
}

TEST_F(OptimizeCommand, FindsAnUnwritableOutputBeforeItReads) {
  const CommandResult result = run("optimize missing.g2o -o no/such/folder/out.g2o");
  EXPECT_EQ(result.exitCode, 6) << result.err;
  write("in.g2o", square);
  const CommandResult json = run("optimize in.g2o -o out.g2o --json no/such/folder/report.json");
  EXPECT_EQ(json.exitCode, 6);
  EXPECT_FALSE(exists("out.g2o"));
}

TEST_F(OptimizeCommand, NamesTheFirstVertexWithoutEstimate) {
  write("edges.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\n");
  const CommandResult result = run("optimize edges.g2o --init file");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_NE(result.err.find("vertex 0 (VERTEX_SE2) has no estimate; 3 of 3"), std::string::npos) << result.err;
  const Json report = optimize("edges.g2o");
  EXPECT_NE(report["initial_guess"], "file");
  EXPECT_TRUE(report["file_chi2"].is_null());
  EXPECT_NEAR(report["final_chi2"].get<double>(), 0.0, 1e-12);
}

TEST_F(OptimizeCommand, SavesTheBestEstimateWhenTimeIsUp) {
  write("in.g2o", square);
  const Json report = optimize("in.g2o -o out.g2o --time-limit 0", 5);
  EXPECT_EQ(report["status"], "time_limit");
  EXPECT_TRUE(exists("out.g2o"));
}

TEST_F(OptimizeCommand, SavesTheFilesEstimateWhenTheInitialGuessIsStopped) {
  write("in.g2o", square);
  const Json report = optimize("in.g2o -o out.g2o --init chordal --time-limit 0", 5);
  EXPECT_EQ(report["status"], "time_limit");
  EXPECT_EQ(report["initial_guess"], "file");
  EXPECT_TRUE(exists("out.g2o"));
}

TEST_F(OptimizeCommand, SavesTheBestEstimateWhenInterrupted) {
  ASSERT_EQ(run("simulate sphere -o in.g2o").exitCode, 0);
  // A slow solver: seconds of work, so that the signal comes in the middle.
  const CommandResult result = run(
      "optimize in.g2o -o out.g2o --init file --solver eigen --json report.json & sleep 0.4; kill -INT $!; wait $!");
  EXPECT_EQ(result.exitCode, 5) << result.out << result.err;
  EXPECT_EQ(Json::parse(read("report.json"))["status"], "interrupted");
  EXPECT_TRUE(exists("out.g2o"));
}

TEST_F(OptimizeCommand, ReadsStandardInputAndTakesFlagsAnywhere) {
  write("in.g2o", square);
  EXPECT_EQ(run("optimize --fix 0,1 in.g2o --quiet").exitCode, 0);
  EXPECT_EQ(run("optimize --fix 0 --fix 1 in.g2o --quiet").exitCode, 0);
  EXPECT_EQ(run("optimize - --quiet -o out.g2o < in.g2o").exitCode, 0);
  EXPECT_TRUE(exists("out.g2o"));
}

TEST_F(OptimizeCommand, StopsAtTheIterationLimit) {
  write("in.g2o", square);
  const Json report = optimize("in.g2o --iterations 1 --init file");
  EXPECT_EQ(report["iterations"].size(), 1u);
  EXPECT_EQ(report["status"], "iteration_limit");
}

TEST_F(OptimizeCommand, HasNothingToDoWhenAllIsFixed) {
  write("in.g2o", square);
  const Json report = optimize("in.g2o --fix 0,1,2,3 --init file -o out.g2o");
  EXPECT_EQ(report["status"], "nothing_to_optimise");
  EXPECT_EQ(report["initial_chi2"], report["final_chi2"]);
  EXPECT_EQ(read("out.g2o").find("FIX"), std::string::npos) << "--fix holds for the run, not for the file";
}

TEST_F(OptimizeCommand, ExplainsAFreeGauge) {
  write("in.g2o", square);
  const CommandResult result = run("optimize in.g2o --algorithm gn --gauge free --init file");
  EXPECT_EQ(result.exitCode, 4);
  EXPECT_NE(result.err.find("vertex 0 (VERTEX_SE2"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("theta [rad]"), std::string::npos) << result.err;
  EXPECT_EQ(optimize("in.g2o --algorithm gn --gauge fix --init file")["gauge"]["fixed"], Json::array({0}));
  EXPECT_EQ(optimize("in.g2o --algorithm lm --init file")["gauge"]["free"], 3);
}

TEST_F(OptimizeCommand, RobustKernelsAreOfTheRunAlone) {
  write("in.g2o", std::string(square) + "EDGE_SE2 0 2 9 9 0 100 0 0 100 0 400\n");
  const Json plain = optimize("in.g2o --init file -o plain.g2o");
  const Json robust = optimize("in.g2o --init file --robust cauchy:1 -o robust.g2o");
  EXPECT_LT(robust["final_cost"], plain["final_cost"]);
  EXPECT_GT(robust["final_chi2"], plain["final_chi2"]);
  EXPECT_EQ(read("robust.g2o").find("kernel"), std::string::npos);
}

TEST_F(OptimizeCommand, EverySolverFindsTheSameOptimum) {
  write("in.g2o", square);
  const double reference = optimize("in.g2o --init file --solver dense")["final_chi2"];
  const Json list = Json::parse(run("list --json -").out);
  for (const Json& solver : list["linear_solvers"]) {
    const std::string name = solver["name"];
    EXPECT_NEAR(optimize("in.g2o --init file --solver " + name)["final_chi2"].get<double>(), reference,
                1e-9 * reference)
        << name;
  }
}

TEST_F(OptimizeCommand, SameBitsForAnyThreadsAndAnyOrderOfLines) {
  ASSERT_EQ(run("simulate sphere -o in.g2o --laps 8 --nodes-per-lap 16 --seed 3").exitCode, 0);
  std::istringstream text(read("in.g2o"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  std::shuffle(lines.begin(), lines.end(), std::mt19937(1));
  std::string shuffled;
  for (const std::string& line : lines) shuffled += line + '\n';
  write("shuffled.g2o", shuffled);
  const auto traceOf = [](const Json& report) {
    std::string trace;
    for (const Json& iteration : report["iterations"]) trace += iteration["chi2"].dump() + ' ';
    return trace;
  };
  const std::string one = traceOf(optimize("in.g2o --threads 1"));
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(traceOf(optimize("in.g2o --threads 2")), one);
  EXPECT_EQ(traceOf(optimize("shuffled.g2o --threads 2")), one);
}

TEST_F(OptimizeCommand, EvaluatesOneFileInBothDialects) {
  ASSERT_EQ(run("simulate sphere -o in.g2o --laps 6 --nodes-per-lap 12").exitCode, 0);
  const Json quaternion = optimize("in.g2o --init file -o quaternion.g2o");
  const Json logarithm = optimize("in.g2o --init file --dialect log -o logarithm.g2o");
  EXPECT_EQ(logarithm["status"], "converged");
  // The logarithm's rotation is twice the quaternion's vector, its information the same: chi2 is larger.
  EXPECT_GT(logarithm["final_chi2"], 1.5 * quaternion["final_chi2"].get<double>());
  EXPECT_NE(read("logarithm.g2o").find("EDGE_SE3:QUAT"), std::string::npos);
  EXPECT_EQ(read("logarithm.g2o").find("EDGE_SE3:LOG"), std::string::npos);
}

}  // namespace
}  // namespace quiver::test
