#include <fmt/format.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

/// The messages of solves that must fail, and the results of graphs that are odd but sound.
class Diagnosis : public CommandTest {
 protected:
  CommandResult fail(const std::string& flags) const {
    CommandResult result = run("optimize in.g2o --algorithm gn --init file --quiet " + flags);
    EXPECT_EQ(result.exitCode, 4) << result.err;
    return result;
  }
};

void expectWords(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\nin: " << text;
}

const std::string plugin = fmt::format("--plugin '{}'", QUIVER_TEST_BEACONS);

TEST_F(Diagnosis, NamesABeaconOfOneRange) {
  write("in.g2o", "VERTEX_SE2 0 0 0 0\nFIX 0\nVERTEX_BEACON 100 0 4\nEDGE_RANGE_SE2_XY 0 100 5.5 10\n");
  expectWords(fail(plugin).err,
              {"in.g2o: ", "vertex 100 (VERTEX_BEACON)", "1 direction: x [m]", "EDGE_RANGE_SE2_XY 0 100"});
}

TEST_F(Diagnosis, SolvesABeaconOfThreeRanges) {
  write("in.g2o",
        "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 6 0 0\nVERTEX_SE2 2 0 1 0\nFIX 0 1 2\nVERTEX_BEACON 100 2 3\n"
        "EDGE_RANGE_SE2_XY 0 100 5 10\nEDGE_RANGE_SE2_XY 1 100 5 10\nEDGE_RANGE_SE2_XY 2 100 4.242640687 10\n");
  const Json report = optimize("in.g2o " + plugin + " --init file -o out.g2o");
  EXPECT_EQ(report["status"], "converged");
  EXPECT_NEAR(report["final_chi2"].get<double>(), 0.0, 1e-12);
}

TEST_F(Diagnosis, NamesAVertexThatOnlyWeightlessEdgesTouch) {
  write("in.g2o", std::string(square) + "VERTEX_SE2 9 5 5 0\nEDGE_SE2 0 9 1 0 0 0 0 0 0 0 0\n");
  expectWords(fail("--gauge free --fix 0").err,
              {"vertex 9 (VERTEX_SE2)", "x [m]", "y [m]", "theta [rad]", "EDGE_SE2 0 9"});
}

TEST_F(Diagnosis, NamesAFreeComponent) {
  write("in.g2o", square);
  expectWords(fail("--gauge free").err, {"vertex 0 (VERTEX_SE2", "x [m]", "y [m]", "theta [rad]", "--fix 0"});
}

TEST_F(Diagnosis, HoldsAVertexInEachComponent) {
  write("in.g2o",
        std::string(square) + "VERTEX_SE2 20 0 0 0\nVERTEX_SE2 21 1 0 0\nEDGE_SE2 20 21 1.5 0 0 1 0 0 1 0 1\n");
  const Json report = optimize("in.g2o --algorithm gn --init file");
  EXPECT_EQ(report["status"], "converged");
  EXPECT_EQ(report["gauge"]["fixed"], Json::array({0, 20}));
}

TEST_F(Diagnosis, SumsParallelEdges) {
  write("in.g2o",
        "VERTEX_SE2 0 0 0 0\nFIX 0\nVERTEX_SE2 1 0 0 0\n"
        "EDGE_SE2 0 1 1 0 0 3 0 0 3 0 3\nEDGE_SE2 0 1 2 0 0 1 0 0 1 0 1\n");
  // The weighted mean is 1.25: chi2 is 3 / 16 + 9 / 16.
  EXPECT_NEAR(optimize("in.g2o --init file")["final_chi2"].get<double>(), 0.75, 1e-12);
}

TEST_F(Diagnosis, LeavesVerticesWithoutEdgesAlone) {
  write("in.g2o", std::string(square) + "VERTEX_SE2 50 7 8 0.5\n");
  const Json report = optimize("in.g2o --init file -o out.g2o");
  EXPECT_EQ(report["status"], "converged");
  EXPECT_NE(read("out.g2o").find("VERTEX_SE2 50 7 8 0.5"), std::string::npos);
}

}  // namespace
}  // namespace quiver::test
