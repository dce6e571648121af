#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using testing::HasSubstr;

/// `quiver optimize --marginals`. The numbers are those of a chain along x, added by hand.
class MarginalsFlag : public CommandTest {
 protected:
  /// The numbers of a vertex's line; empty if there is none.
  static std::vector<double> covariance(const std::string& text, const std::string& tag, int id) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string word;
      int number = -1;
      if (!(words >> word >> number) || word != tag || number != id) continue;
      std::vector<double> values;
      for (double value; words >> value;) values.push_back(value);
      return values;
    }
    return {};
  }

  static constexpr const char* chain =
      "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 2 0 0\n"
      "EDGE_SE2 0 1 1 0 0 4 0 0 4 0 100\nEDGE_SE2 1 2 1 0 0 4 0 0 4 0 100\n";
};

TEST_F(MarginalsFlag, WritesUpperTrianglesOfEveryVertex) {
  write("chain.g2o", chain);
  const nlohmann::json report = optimize("chain.g2o --marginals covariances.txt");
  EXPECT_GE(report["seconds"]["marginals"].get<double>(), 0.0);
  const std::string text = read("covariances.txt");
  EXPECT_THAT(text, HasSubstr("# VERTEX_SE2: "));
  EXPECT_THAT(text, HasSubstr("vertex 0 held"));
  EXPECT_THAT(covariance(text, "VERTEX_SE2", 0), testing::SizeIs(0));
  EXPECT_THAT(covariance(text, "VERTEX_SE2", 1),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.25, 0.0, 0.0, 0.25, 0.0, 0.01}));
  // A turn at vertex 1 moves vertex 2, one metre ahead, sideways.
  EXPECT_THAT(covariance(text, "VERTEX_SE2", 2),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.5, 0.0, 0.0, 0.51, 0.01, 0.02}));
}

TEST_F(MarginalsFlag, CountsWhatTheCommandLineFixesAndLeavesTheOutputAsItIs) {
  write("chain.g2o", chain);
  EXPECT_EQ(run("optimize chain.g2o --fix 2 --marginals - -o with.g2o --quiet").exitCode, 0);
  const CommandResult result = run("optimize chain.g2o --fix 2 --marginals - -o with.g2o");
  EXPECT_THAT(covariance(result.out, "VERTEX_SE2", 1),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.25, 0.0, 0.0, 0.26, -0.01, 0.01}));
  EXPECT_THAT(result.err, HasSubstr("converged"));
  EXPECT_EQ(run("optimize chain.g2o --fix 2 -o without.g2o").exitCode, 0);
  EXPECT_EQ(read("with.g2o"), read("without.g2o"));
}

TEST_F(MarginalsFlag, NamesVerticesThatHaveNone) {
  write("bearing.g2o", std::string(chain) + "VERTEX_XY 7 1 1\nEDGE_BEARING_SE2_XY 0 7 0.7853981633974483 100\n");
  const nlohmann::json report = optimize("bearing.g2o --marginals covariances.txt");
  EXPECT_EQ(report["marginals"]["undetermined"], nlohmann::json::array({7}));
  EXPECT_EQ(report["marginals"]["written"], true);
  const std::string text = read("covariances.txt");
  EXPECT_THAT(text, HasSubstr("# vertex 7 is not constrained in every direction"));
  EXPECT_THAT(covariance(text, "VERTEX_XY", 7), testing::IsEmpty());
  EXPECT_THAT(covariance(text, "VERTEX_SE2", 1), testing::SizeIs(6));
}

TEST_F(MarginalsFlag, EndsWithFourWhereNoVertexHasOne) {
  write("chain.g2o", chain);
  const CommandResult result = run("optimize chain.g2o --gauge free --marginals covariances.txt -o out.g2o --json r");
  EXPECT_EQ(nlohmann::json::parse(read("r"))["marginals"]["written"], false);
  EXPECT_EQ(result.exitCode, 4);
  EXPECT_THAT(result.err, HasSubstr("chain.g2o: --marginals: covariances do not exist: "));
  EXPECT_TRUE(exists("out.g2o"));
  EXPECT_FALSE(exists("covariances.txt"));
}

TEST_F(MarginalsFlag, AreNotComputedForADescentThatWasStopped) {
  write("chain.g2o", chain);
  const CommandResult result = run("optimize chain.g2o --time-limit 0 --marginals covariances.txt");
  EXPECT_EQ(result.exitCode, 5);
  EXPECT_THAT(result.err, HasSubstr("--marginals: not computed"));
  EXPECT_FALSE(exists("covariances.txt"));
}

TEST_F(MarginalsFlag, AreWrittenThoughNobodyReadsTheProgress) {
  write("chain.g2o", chain);
  run("optimize chain.g2o -o out.g2o --json report.json --marginals covariances.txt | true");
  EXPECT_TRUE(exists("out.g2o"));
  EXPECT_TRUE(exists("report.json"));
  EXPECT_TRUE(exists("covariances.txt"));
}

TEST_F(MarginalsFlag, OfThousandsOfOpenPointsTakeNoTime) {
  std::string text = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 4 0 0 4 0 100\n";
  for (int i = 0; i < 20000; ++i) {
    text += "VERTEX_XY " + std::to_string(10 + i) + " 1 " + std::to_string(1 + i % 7) + "\n";
    text += "EDGE_BEARING_SE2_XY 0 " + std::to_string(10 + i) + " 0.5 100\n";
  }
  write("many.g2o", text);
  const nlohmann::json report = optimize("many.g2o --fix 0 --marginals covariances.txt --time-limit 60");
  EXPECT_EQ(report["marginals"]["vertices"], 1);
  EXPECT_EQ(report["marginals"]["undetermined"].size(), 20000u);
}

TEST_F(MarginalsFlag, ThatCannotBeWrittenCostNothingElse) {
  // macOS has no device that is always full.
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  write("chain.g2o", chain);
  EXPECT_EQ(run("optimize chain.g2o --marginals /dev/full -o out.g2o --json report.json").exitCode, 6);
  EXPECT_TRUE(exists("out.g2o"));
  ASSERT_TRUE(exists("report.json"));
  EXPECT_EQ(nlohmann::json::parse(read("report.json"))["marginals"]["written"], false);
}

TEST_F(MarginalsFlag, MayNotReplaceTheGraphOrAnotherOutput) {
  write("chain.g2o", chain);
  EXPECT_EQ(run("optimize chain.g2o --marginals chain.g2o").exitCode, 2);
  EXPECT_EQ(run("optimize chain.g2o --marginals same --json same").exitCode, 2);
  EXPECT_EQ(run("optimize chain.g2o --marginals no/such/folder/file").exitCode, 6);
  EXPECT_EQ(read("chain.g2o"), chain);
}

}  // namespace
}  // namespace quiver::test
