#include <cmath>
#include <fstream>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

using Json = nlohmann::json;

class PublishedGraphs : public CommandTest {
 protected:
  /// The report of a run on a published graph; nothing if the graph is not there.
  Json optimizeGraph(const std::string& name, const std::string& flags) const {
    const std::string path = publishedGraph(name);
    if (path.empty()) return Json();
    return optimize("'" + path + "' " + flags);
  }
};

#define REPORT_OR_SKIP(report, name, flags)       \
  const Json report = optimizeGraph(name, flags); \
  if (report.is_null()) GTEST_SKIP() << whyMissing(std::string(name) + ".g2o")

/// What a published file's own estimates have, to the digits published.
struct InitialChi2 {
  const char* name;
  double chi2;
};

TEST_F(PublishedGraphs, StartWithTheirKnownChi2) {
  constexpr InitialChi2 table[] = {
      {"sphere_noisy", 9540414859.315}, {"sphere2500", 2547810.8488}, {"torus3D", 2946826.5454},
      {"parking-garage", 16720.0183},   {"intel", 551.735731},        {"intel_odometry", 5149721.0448},
      {"M3500", 2566667.6592},          {"MIT", 4414181662.5}};
  for (const auto& [name, chi2] : table) {
    REPORT_OR_SKIP(report, name, "--init file --iterations 0");
    EXPECT_NEAR(report["file_chi2"].get<double>(), chi2, 1e-6 * chi2) << name;
    EXPECT_EQ(report["file_chi2"], report["initial_chi2"]) << name;
  }
}

void expectTrace(const Json& report, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(publishedGraph(name)).parent_path();
  std::ifstream trace(folder / "traces" / (name + ".gn.csv"));
  std::string line;
  std::getline(trace, line);  // heading
  std::getline(trace, line);  // before the first step
  std::size_t compared = 0;
  for (; compared < report["iterations"].size() && std::getline(trace, line); ++compared) {
    const double expected = std::stod(line.substr(line.find(',') + 1));
    // The published traces have six decimals.
    EXPECT_NEAR(report["iterations"][compared]["chi2"].get<double>(), expected, 1e-6 * expected + 1e-6)
        << name << " iteration " << compared;
  }
  EXPECT_GE(compared, 3u) << name;
}

TEST_F(PublishedGraphs, FollowTheGaussNewtonTraceOfIntel) {
  REPORT_OR_SKIP(report, "intel", "--algorithm gn --init file --fix 0");
  expectTrace(report, "intel");
}

TEST_F(PublishedGraphs, FollowTheGaussNewtonTraceOfM3500) {
  REPORT_OR_SKIP(report, "M3500", "--algorithm gn --init file --fix 0");
  expectTrace(report, "M3500");
}

/// Steps until chi2 is within 1e-6 of the optimum; −1 if it never is.
int stepsToOptimum(const Json& report, double optimum) {
  for (const Json& iteration : report["iterations"]) {
    if (iteration["chi2"].get<double>() <= optimum * (1.0 + 1e-6)) return iteration["iteration"].get<int>() + 1;
  }
  return -1;
}

void expectOptimum(const Json& report, const char* name, double optimum) {
  EXPECT_EQ(report["status"], "converged") << name;
  EXPECT_LE(report["final_chi2"].get<double>(), optimum * (1.0 + 1e-6)) << name;
}

struct Optimum {
  const char* name;
  double chi2;
  int steps;
};

TEST_F(PublishedGraphs, GaussNewtonNeedsFewStepsInSpace) {
  constexpr Optimum table[] = {
      {"sphere2500", 727.1496672, 9}, {"parking-garage", 1.23869058, 3}, {"sphere_noisy", 44360.6215, 4}};
  for (const auto& [name, chi2, steps] : table) {
    REPORT_OR_SKIP(report, name, "--algorithm gn --init file --fix 0");
    const int needed = stepsToOptimum(report, chi2);
    EXPECT_GT(needed, 0) << name;
    EXPECT_LE(needed, steps) << name;
  }
}

TEST_F(PublishedGraphs, ReachTheBestKnownByDefault) {
  constexpr Optimum table[] = {{"sphere_noisy", 44360.6215, 0},
                               {"sphere2500", 727.1496672, 0},
                               {"parking-garage", 1.23869058, 0},
                               {"intel", 45.00469581, 0},
                               {"M3500", 137.9129509, 0}};
  for (const auto& [name, chi2, steps] : table) {
    REPORT_OR_SKIP(report, name, "");
    expectOptimum(report, name, chi2);
    REPORT_OR_SKIP(fromFile, name, "--init file");
    expectOptimum(fromFile, name, chi2);
  }
}

TEST_F(PublishedGraphs, ReachTheBestKnownFromATree) {
  constexpr Optimum table[] = {{"torus3D", 14574.74644, 0},
                               {"MIT", 41.16326884, 0},
                               {"intel_odometry", 215.8302349, 0},
                               {"manhattan", 3549.036796, 0}};
  for (const auto& [name, chi2, steps] : table) {
    REPORT_OR_SKIP(report, name, "--init tree");
    expectOptimum(report, name, chi2);
    EXPECT_EQ(report["initial_guess"], "tree");
  }
}

TEST_F(PublishedGraphs, SameBitsForAnyThreads) {
  for (const char* name : {"M3500", "sphere2500"}) {
    REPORT_OR_SKIP(one, name, "--threads 1");
    REPORT_OR_SKIP(two, name, "--threads 2");
    EXPECT_EQ(one["final_chi2"].dump(), two["final_chi2"].dump()) << name;
    EXPECT_EQ(one["iterations"].size(), two["iterations"].size()) << name;
  }
}

TEST_F(PublishedGraphs, SaveTheBestEstimateWhenTimeIsUp) {
  const std::string path = publishedGraph("torus3D");
  if (path.empty()) GTEST_SKIP() << whyMissing("torus3D.g2o");
  const Json report = optimize("'" + path + "' --time-limit 0.1 --init file -o out.g2o", 5);
  EXPECT_EQ(report["status"], "time_limit");
  EXPECT_TRUE(exists("out.g2o"));
}

}  // namespace
}  // namespace quiver::test
