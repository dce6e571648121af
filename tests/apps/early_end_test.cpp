// Runs that end before there is an estimate to save: what is wrong is told all the same, and the report is written.
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class EarlyEnd : public CommandTest {
 protected:
  /// A report of a run that evaluated nothing.
  void expectUnmoved(const std::string& status) const {
    const Json report = Json::parse(read("report.json"));
    EXPECT_EQ(report["status"], status);
    for (const char* key : {"file_chi2", "initial_chi2", "final_chi2", "initial_cost", "final_cost"})
      EXPECT_TRUE(report[key].is_null()) << key;
    EXPECT_TRUE(report["iterations"].empty());
    EXPECT_FALSE(exists("out.g2o"));
  }
};

/// Two poses without estimates.
const char* const edges = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\n";

TEST_F(EarlyEnd, BadInputIsNoMatterOfTime) {
  write("in.g2o", square);
  write("untold.g2o", "VERTEX_SE2 0 0 0 0\n#quiver vertex VERTEX_SEGMENT2D 5\nEDGE_SE2_SEGMENT2D_LINE 0 5 0 2 1 0 1\n");
  for (const char* arguments :
       {"in.g2o --fix 99", "in.g2o --only 99", "in.g2o --robust huber:1e300", "in.g2o --robust-edges EDGE_SE2",
        "in.g2o --algorithm newton", "in.g2o --init file --only 99", "untold.g2o"}) {
    const CommandResult patient = run(fmt::format("optimize {} --quiet", arguments));
    const CommandResult hasty = run(fmt::format("optimize {} --quiet --time-limit 0", arguments));
    EXPECT_TRUE(patient.exitCode == 2 || patient.exitCode == 3) << arguments << patient.exitCode;
    EXPECT_EQ(hasty.exitCode, patient.exitCode) << arguments;
    EXPECT_EQ(hasty.err, patient.err) << arguments;
  }
  EXPECT_EQ(run("optimize in.g2o --fix 99 --time-limit 0").exitCode, 3);
  EXPECT_EQ(run("optimize in.g2o --only 99 --time-limit 0").exitCode, 3);
  EXPECT_EQ(run("optimize untold.g2o --time-limit 0").exitCode, 3);
}

TEST_F(EarlyEnd, AStoppedInitialGuessIsReported) {
  write("edges.g2o", edges);
  const Json report = optimize("edges.g2o -o out.g2o --init chordal --time-limit 0", 5);
  expectUnmoved("time_limit");
  EXPECT_EQ(report["input"]["edges"]["EDGE_SE2"], 2);
  EXPECT_THAT(report["reason"].get<std::string>(), HasSubstr("initial guess"));
  const CommandResult told = run("optimize edges.g2o --init chordal --time-limit 0 --quiet");
  EXPECT_EQ(told.err, "edges.g2o: stopped while making the initial guess; no estimate is written\n");
}

TEST_F(EarlyEnd, AnInterruptWhileReadingIsReported) {
  write("in.g2o", square);
  const CommandResult result = run("--version; mkfifo pipe; '" QUIVER_COMMAND
                                   "' optimize - -o out.g2o --json report.json < pipe & "
                                   "{ sleep 1; kill -TERM $!; sleep 0.2; cat in.g2o; } > pipe; wait $!");
  EXPECT_EQ(result.exitCode, 5) << result.err;
  EXPECT_THAT(result.err, HasSubstr("<stdin>: stopped while reading"));
  expectUnmoved("interrupted");
}

TEST_F(EarlyEnd, WantOfMemoryIsReported) {
  write("edges.g2o", edges);
  (void)optimize(fmt::format("edges.g2o -o out.g2o --init exhausting --plugin '{}'", QUIVER_TEST_BEACONS), 4);
  expectUnmoved("memory_limit");
}

}  // namespace
}  // namespace quiver::test
