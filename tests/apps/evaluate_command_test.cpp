#include <cmath>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class EvaluateCommand : public CommandTest {};

TEST_F(EvaluateCommand, ComparesGraphsAfterAlignment) {
  write("truth.g2o", "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 1 1 0\n");
  // The same triangle turned by a right angle and moved.
  write("turned.g2o",
        "VERTEX_SE2 0 5 5 1.5707963267948966\nVERTEX_SE2 1 5 6 1.5707963267948966\nVERTEX_SE2 2 4 6 "
        "1.5707963267948966\n");
  const Json json = Json::parse(run("evaluate turned.g2o truth.g2o --json -").out);
  EXPECT_EQ(json["alignment"]["group"], "se2");
  EXPECT_EQ(json["matched_poses"], 3);
  EXPECT_NEAR(json["absolute"]["translation_m"]["max"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(json["absolute"]["rotation_rad"]["max"].get<double>(), 0.0, 1e-12);
  const Json none = Json::parse(run("evaluate turned.g2o truth.g2o --align none --json -").out);
  EXPECT_NEAR(none["absolute"]["translation_m"]["min"].get<double>(), std::sqrt(34.0), 1e-12);  // (4,6)-(1,1)
  EXPECT_NEAR(none["absolute"]["rotation_rad"]["mean"].get<double>(), 1.5707963267948966, 1e-12);
  const CommandResult table = run("evaluate turned.g2o truth.g2o -o e.svg");
  EXPECT_NE(table.out.find("absolute translation m"), std::string::npos);
  EXPECT_NE(read("e.svg").find("</svg>"), std::string::npos);
}

TEST_F(EvaluateCommand, ReadsTrajectoriesAndStandardInput) {
  write("a.txt", "# tum\n0 0 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n2 2 2 0 0 0 0 1\n");
  write("b.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 1 0 0 1 0\n");
  const CommandResult scaled = run("evaluate - b.txt --align sim3 --json - < a.txt");
  ASSERT_EQ(scaled.exitCode, 0) << scaled.err;
  EXPECT_NEAR(Json::parse(scaled.out)["alignment"]["scale"].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(Json::parse(scaled.out)["absolute"]["translation_m"]["max"].get<double>(), 0.0, 1e-12);
}

TEST_F(EvaluateCommand, RefusesWhatMakesNoSense) {
  write("a.txt", "0 0 0 0 0 0 0 1\n1 2 0 0 0 0 0\n");
  write("b.txt", "0 0 0 0 0 0 0 1\n");
  const CommandResult bad = run("evaluate a.txt b.txt");
  EXPECT_EQ(bad.exitCode, 3);
  EXPECT_NE(bad.err.find("a.txt:2:"), std::string::npos) << bad.err;
  EXPECT_EQ(run("evaluate b.txt b.txt --align so3").exitCode, 2);
  EXPECT_EQ(run("evaluate b.txt b.txt --align se2").exitCode, 3);
  EXPECT_EQ(run("evaluate b.txt b.txt --step 2 --step-metres 1").exitCode, 2);
  EXPECT_EQ(run("evaluate - - < b.txt").exitCode, 2);
  EXPECT_EQ(run("evaluate b.txt b.txt -o missing/e.svg").exitCode, 6);
}

}  // namespace
}  // namespace quiver::test
