#include <algorithm>
#include <filesystem>
#include <random>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

/// The command among closed streams, full disks, odd files and senseless numbers.
class Surroundings : public CommandTest {};

TEST_F(Surroundings, NothingSaidLandsInAnOutputOfAProgramWithoutStreams) {
  write("in.g2o", square);
  ASSERT_EQ(run("optimize in.g2o -o expected.g2o --quiet").exitCode, 0);
  EXPECT_EQ(run("optimize in.g2o -o out.g2o <&- >&- 2>&-").exitCode, 6) << "what it says is lost";
  EXPECT_EQ(read("out.g2o"), read("expected.g2o"));
  EXPECT_EQ(run("optimize in.g2o -o quiet.g2o --quiet <&- >&- 2>&-").exitCode, 0);
  EXPECT_EQ(read("quiet.g2o"), read("expected.g2o"));
}

TEST_F(Surroundings, AClosedInputIsRefused) {
  const CommandResult result = run("optimize - <&-");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_THAT(result.err, StartsWith("<stdin>: "));
}

TEST_F(Surroundings, AnInputOfZerosEnds) {
  const CommandResult result = run("info /dev/zero");
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_THAT(result.err, StartsWith("/dev/zero:1:1: "));
}

TEST_F(Surroundings, TextThatIsLostIsNoSuccess) {
  // macOS has no device that is always full.
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  write("in.g2o", square);
  for (const char* command : {"list", "info in.g2o", "--help", "--version", "optimize --help"}) {
    for (const char* sink : {">/dev/full", ">&-"}) {
      const CommandResult result = run(std::string(command) + " " + sink);
      EXPECT_EQ(result.exitCode, 6) << command << sink;
      EXPECT_THAT(result.err, StartsWith("<stdout>: cannot be written: ")) << command << sink;
    }
  }
  // The work is done all the same.
  EXPECT_EQ(run("optimize in.g2o -o out.g2o >/dev/full").exitCode, 6);
  EXPECT_TRUE(exists("out.g2o"));
  // What was wrong before counts more, and needs no stream to be told on.
  EXPECT_EQ(run("optimize missing.g2o >/dev/full 2>/dev/full").exitCode, 3);
  EXPECT_EQ(run("optimize missing.g2o 2>&-").exitCode, 3);
}

TEST_F(Surroundings, OddFilesAreRefused) {
  std::filesystem::create_directory(folder() / "folder");
  write("empty.g2o", "");
  for (const char* command : {"optimize", "info"}) {
    EXPECT_EQ(run(std::string(command) + " folder").err, "folder: is a directory, not a file\n");
    EXPECT_EQ(run(std::string(command) + " folder").exitCode, 3);
    EXPECT_EQ(run(std::string(command) + " empty.g2o").err, "empty.g2o: the file holds no vertex and no edge\n");
    EXPECT_EQ(run(std::string(command) + " empty.g2o").exitCode, 3);
  }
}

TEST_F(Surroundings, OutputsThatCannotBeAreFoundBeforeReading) {
  std::filesystem::create_directory(folder() / "folder");
  for (const char* flag : {"-o folder", "--json folder", "-o no/such/out.g2o", "--json no/such/out.json"}) {
    const CommandResult result = run(std::string("optimize missing.g2o ") + flag);
    EXPECT_EQ(result.exitCode, 6) << flag << result.err;
  }
  for (const char* flags : {"-o - --json -", "-o x --json x"})
    EXPECT_EQ(run(std::string("optimize missing.g2o ") + flags).exitCode, 2) << flags;
}

TEST_F(Surroundings, NumbersBeyondAllMeasureHaveADefinedResult) {
  write("huge.g2o",
        "VERTEX_SE2 0 1e308 1e308 0\nVERTEX_SE2 1 -1e308 -1e308 0\nEDGE_SE2 0 1 1 0 0 1e308 0 0 1e308 0 1e308\n");
  const CommandResult result = run("optimize huge.g2o --init file --json report.json");
  EXPECT_EQ(result.exitCode, 4);
  EXPECT_THAT(result.err, HasSubstr("the error of edge EDGE_SE2 0 1 is not finite at the start"));
  EXPECT_EQ(result.out.find("nan"), std::string::npos) << result.out;
  const Json report = Json::parse(read("report.json"));
  EXPECT_EQ(report["status"], "numerical_failure");
  EXPECT_TRUE(report["initial_chi2"].is_null());
  EXPECT_TRUE(report["final_chi2"].is_null());
}

TEST_F(Surroundings, NothingIsReportedThatWasNotEvaluated) {
  write("in.g2o", square);
  const Json report = optimize("in.g2o --init file --memory-limit 100", 4);
  EXPECT_EQ(report["status"], "memory_limit");
  EXPECT_TRUE(report["initial_chi2"].is_null());
  const std::string told = run("optimize in.g2o --init file --memory-limit 100").out;
  EXPECT_THAT(told, HasSubstr("memory_limit: "));
  EXPECT_EQ(told.find("chi2"), std::string::npos) << told;
}

TEST_F(Surroundings, ARefusedSolveLeavesTheOldOutput) {
  write("in.g2o", square);
  write("out.g2o", "what was there before");
  EXPECT_EQ(run("optimize in.g2o -o out.g2o --memory-limit 100").exitCode, 4);
  EXPECT_EQ(read("out.g2o"), "what was there before");
}

TEST_F(Surroundings, UsageErrorsSayWhatWouldDo) {
  write("in.g2o", square);
  struct Wrong {
    const char* flags;
    const char* message;
  };
  for (const auto& [flags, message] :
       {Wrong{"--gauge 0", "--gauge: '0' is none of auto, fix, free"},
        Wrong{"--gauge fixed", "--gauge: 'fixed' is none of auto, fix, free"},
        Wrong{"--dialect 1", "--dialect: '1' is none of g2o, log"},
        Wrong{"--information 1", "--information: '1' is none of check, clamp"},
        Wrong{"--unknown 1", "--unknown: '1' is none of error, keep, skip"},
        Wrong{"--time-limit -1", "--time-limit: '-1' is no number of at least 0"},
        Wrong{"--time-limit 0x10", "--time-limit: '0x10' is no number of at least 0"},
        Wrong{"--time-limit nan", "--time-limit: 'nan' is no number of at least 0"},
        Wrong{"--time-limit inf", "--time-limit: 'inf' is no number of at least 0"},
        Wrong{"--fix a", "--fix: 'a' is no id of a vertex"},
        Wrong{"--fix 1.5", "--fix: '1.5' is no id of a vertex"},
        Wrong{"--fix 0,-1", "--fix: '-1' is no id of a vertex"},
        Wrong{"--only 99999999999999999999", "--only: '99999999999999999999' is no id of a vertex"},
        Wrong{"--memory-limit 0", "--memory-limit: '0' is no number of at least 1"},
        Wrong{"--fix 1,,2", "--fix: in the list '1,,2' a word is missing at a ','"},
        Wrong{"--fix 1,", "--fix: in the list '1,' a word is missing"},
        Wrong{"--fix ,1", "--fix: in the list ',1' a word is missing"},
        Wrong{"--fix ,", "--fix: in the list ',' a word is missing"},
        Wrong{"--fix ''", "--fix: '' is no id of a vertex"},
        Wrong{"--fix '1 ,2'", "--fix: '1 ' is no id of a vertex"},
        Wrong{"--fix 1 --fix 2,,3", "--fix: in the list '2,,3' a word is missing"},
        Wrong{"--only 1,,2", "--only: in the list '1,,2' a word is missing"},
        Wrong{"--eliminate VERTEX_SE2,,VERTEX_XY", "--eliminate: in the list"},
        Wrong{"--eliminate ''", "--eliminate: the list is empty"},
        Wrong{"--robust huber --robust-edges EDGE_SE2,", "--robust-edges: in the list"},
        Wrong{"--robust huber --robust-edges ''", "--robust-edges: the list is empty"},
        Wrong{"--robust ''", "--robust: the name of the kernel is empty"},
        Wrong{"--plugin ''", "--plugin: the path of the file to read is empty"},
        Wrong{"--iterations 1.5", "--iterations: '1.5' is no whole number of at least 0"},
        Wrong{"--iterations -1", "--iterations: '-1' is no whole number of at least 0"},
        Wrong{"--threads 5000", "--threads: '5000' is no whole number from 0 to 4096"},
        Wrong{"--linear-tolerance nan", "--linear-tolerance: 'nan' is no number from 1e-16 to 0.999"},
        Wrong{"--linear-tolerance 0", "--linear-tolerance: '0' is no number from 1e-16 to 0.999"},
        Wrong{"--eliminate none", "--eliminate none: no such vertex type"},
        Wrong{"--eliminate off,VERTEX_SE2", "--eliminate: 'off' stands alone"}}) {
    const CommandResult result = run(std::string("optimize in.g2o ") + flags);
    EXPECT_EQ(result.exitCode, 2) << flags;
    EXPECT_THAT(result.err, HasSubstr(message)) << flags;
  }
  for (const char* flags :
       {"--gauge fix", "--gauge free", "--dialect g2o", "--information clamp", "--unknown keep", "--fix 0,3",
        "--fix 0 --fix 1,2", "--eliminate off", "--memory-limit 1gb", "--time-limit 100"})
    EXPECT_EQ(run(std::string("optimize in.g2o ") + flags).exitCode, 0) << flags;
}

TEST_F(Surroundings, NumbersAreDecimal) {
  std::string text;
  for (int i = 0; i < 12; ++i) text += "VERTEX_SE2 " + std::to_string(i) + " 0 0 0\n";
  for (int i = 0; i < 11; ++i)
    text += "EDGE_SE2 " + std::to_string(i) + " " + std::to_string(i + 1) + " 1 0 0 1 0 0 1 0 1\n";
  write("in.g2o", text);
  ASSERT_EQ(run("optimize in.g2o -o out.g2o --quiet --init file --only 011").exitCode, 0);
  const std::string result = read("out.g2o");
  EXPECT_NE(result.find("VERTEX_SE2 9 0 0 0\n"), std::string::npos) << "as 011 would be in octal digits\n" << result;
  EXPECT_EQ(result.find("VERTEX_SE2 11 0 0 0\n"), std::string::npos) << result;
}

TEST_F(Surroundings, AMissingOrUnknownCommandIsNamed) {
  struct Wrong {
    const char* words;
    const char* message;
  };
  for (const auto& [words, message] :
       {Wrong{"", "quiver is to do what? there are optimize, info"}, Wrong{"optmize x", "did you mean 'optimize'?"},
        Wrong{"foo", "quiver does not know 'foo'; there are optimize"},
        Wrong{"--foo", "what it is to do comes before '--foo'; there are optimize"},
        Wrong{"simulate", "simulate is to do what? there are sphere"},
        Wrong{"simulate spher -o x.g2o", "simulate does not know 'spher', did you mean 'sphere'?"},
        Wrong{"simulate sphere -o x.g2o --lap 3", "sphere has no flag '--lap', did you mean '--laps'?"}}) {
    const CommandResult result = run(words);
    EXPECT_EQ(result.exitCode, 2) << words;
    EXPECT_THAT(result.err, HasSubstr(message)) << words;
  }
}

/// A file's lines in another order.
std::string shuffled(const std::string& text, unsigned seed) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::shuffle(lines.begin(), lines.end(), std::mt19937(seed));
  std::string result;
  for (const std::string& line : lines) result += line + '\n';
  return result;
}

/// A file's lines in alphabetical order.
std::string sorted(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  std::string result;
  for (const std::string& line : lines) result += line + '\n';
  return result;
}

TEST_F(Surroundings, ThreadsAndTheOrderOfLinesChangeNoBitOfAnyEstimate) {
  for (const char* world : {"sphere -o in.g2o --laps 8 --nodes-per-lap 16 --seed 3",
                            "bundle -o in.g2o --cameras 12 --points 300 --seed 3"}) {
    ASSERT_EQ(run(std::string("simulate ") + world).exitCode, 0);
    write("shuffled.g2o", shuffled(read("in.g2o"), 1));
    ASSERT_EQ(run("optimize in.g2o -o one.g2o --threads 1 --iterations 8 --quiet").exitCode, 0) << world;
    const std::string expected = sorted(read("one.g2o"));
    EXPECT_NE(expected, sorted(read("in.g2o"))) << world;
    for (const char* again :
         {"in.g2o --threads 2", "in.g2o --threads 3", "shuffled.g2o --threads 1", "shuffled.g2o --threads 2"}) {
      ASSERT_EQ(run(std::string("optimize -o other.g2o --iterations 8 --quiet ") + again).exitCode, 0) << again;
      EXPECT_EQ(sorted(read("other.g2o")), expected) << world << ": " << again;
    }
  }
}

}  // namespace
}  // namespace quiver::test
