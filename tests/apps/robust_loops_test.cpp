#include <set>
#include <sstream>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <benchmarks/robust_trajectories.h>

#include "tests/apps/command_runner.h"

namespace quiver::test {
namespace {

/// The command's answer to wrong loop closures, started from odometry.
class RobustLoops : public CommandTest {
 protected:
  Eigen::MatrixXd clean(const std::string& path) const {
    optimize("'" + path + "' -o clean.g2o --quiet");
    return positions("clean.g2o");
  }
  Eigen::MatrixXd robust(const std::string& path, double fraction, int seed) const {
    EXPECT_EQ(
        run(fmt::format("simulate outliers '{}' -o wrong.g2o --fraction {} --seed {}", path, fraction, seed)).exitCode,
        0);
    optimize("wrong.g2o -o robust.g2o --quiet --init odometry --robust dcs:1 --robust-edges loops --iterations 300");
    return positions("robust.g2o");
  }

 private:
  Eigen::MatrixXd positions(const std::string& name) const {
    return positionsOf(readGraph((folder() / name).string(), builtinRegistry()));
  }
};

TEST_F(RobustLoops, OfATenthM3500EndsAsNearTheTruthAsTheCleanGraph) {
  const std::string path = publishedGraph("M3500");
  if (path.empty()) GTEST_SKIP() << whyMissing("M3500.g2o");
  double worst = 0.0;
  const Eigen::MatrixXd truth = latticeTruth(readGraph(path, builtinRegistry()), worst);
  ASSERT_LT(worst, 0.2) << "the world is no lattice";
  const double best = trajectoryError(clean(path), truth);
  for (const int seed : {1, 2, 3}) EXPECT_LT(trajectoryError(robust(path, 0.1, seed), truth), 1.2 * best) << seed;
}

TEST_F(RobustLoops, OfATenthSphere2500EndsWhereTheCleanGraphDoes) {
  const std::string path = publishedGraph("sphere2500");
  if (path.empty()) GTEST_SKIP() << whyMissing("sphere2500.g2o");
  const Eigen::MatrixXd best = clean(path);
  // The truth is some trajectory on a sphere, so the clean one errs by its distance from the sphere at least, and a
  // result that departs from it by less than a fifth of that errs less than 1.2 times as much.
  const double least = distanceFromSphere(best);
  EXPECT_LT(trajectoryError(robust(path, 0.1, 1), best), 0.2 * least);
}

TEST_F(RobustLoops, AreDrawnTheSameForASeedAndCounted) {
  write("ring.g2o",
        "EDGE_SE2 0 1 1 0 1.57 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 1.57 1 0 0 1 0 1\nEDGE_SE2 2 3 1 0 1.57 1 0 0 1 0 1\n"
        "EDGE_SE2 3 4 1 0 1.57 1 0 0 1 0 1\nEDGE_SE2 4 5 1 0 1.57 1 0 0 1 0 1\nEDGE_SE2 5 6 1 0 1.57 1 0 0 1 0 1\n"
        "EDGE_SE2 4 0 0.1 0 6.28 1 0 0 1 0 1\nEDGE_SE2 5 1 0.2 0 6.28 1 0 0 1 0 1\n");
  for (const char* name : {"a.g2o", "b.g2o"})
    EXPECT_EQ(run(fmt::format("simulate outliers ring.g2o -o {} --fraction 1 --seed 5", name)).exitCode, 0);
  EXPECT_EQ(run("simulate outliers ring.g2o -o c.g2o --fraction 1 --seed 6").exitCode, 0);
  EXPECT_EQ(read("a.g2o"), read("b.g2o"));
  EXPECT_NE(read("a.g2o"), read("c.g2o"));
  const Graph graph = readGraph((folder() / "a.g2o").string(), builtinRegistry());
  EXPECT_EQ(graph.edgeCount(), 10);
  EXPECT_EQ(run("simulate outliers ring.g2o -o d.g2o --fraction 1000").exitCode, 3);
  write("chain.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  EXPECT_EQ(run("simulate outliers chain.g2o -o d.g2o").exitCode, 3);
}

TEST_F(RobustLoops, DoNotDependOnTheOrderOfTheFile) {
  const std::string chain =
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 2 3 1 0 0 1 0 0 1 0 1\n"
      "EDGE_SE2 3 4 1 0 0 1 0 0 1 0 1\nEDGE_SE2 4 5 1 0 0 1 0 0 1 0 1\nEDGE_SE2 5 6 1 0 0 1 0 0 1 0 1\n";
  const std::vector<std::string> loops{"EDGE_SE2 0 3 3 0 0 1 0 0 1 0 1\n", "EDGE_SE2 0 3 3.5 0 0 1 0 0 1 0 1\n",
                                       "EDGE_SE2 0 3 4.5 0 0 1 0 0 1 0 1\n"};
  write("a.g2o", chain + loops[0] + loops[1] + loops[2]);
  write("b.g2o", chain + loops[2] + loops[1] + loops[0]);
  std::vector<std::multiset<std::string>> lines;
  for (const std::string name : {"a", "b"}) {
    EXPECT_EQ(run(fmt::format("simulate outliers {0}.g2o -o {0}_out.g2o --fraction 1 --seed 2", name)).exitCode, 0);
    std::istringstream text(read(name + "_out.g2o"));
    auto& own = lines.emplace_back();
    for (std::string line; std::getline(text, line);) own.insert(line);
  }
  EXPECT_EQ(lines[0], lines[1]);
}

}  // namespace
}  // namespace quiver::test
