// What Gauss–Newton holds of a world that may move: never more than the freedom there is, so no minimum is lost.
#include <bit>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/gauge.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/plugins/builtin.h>

namespace quiver {
namespace {

struct World {
  const char* name;
  const char* text;
};

const World worlds[] = {
    {"one position of a chain is known",
     "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_SE2 2 2 0 0\n"
     "EDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\nEDGE_SE2 1 2 1 0 0 100 0 0 100 0 100\n"
     "EDGE_PRIOR_SE2_XY 2 100 50 1 0 1\n"},
    {"a compass",
     "VERTEX_SE2 0 0 0 0.3\nVERTEX_SE2 1 1 0 0.3\nVERTEX_SE2 2 2 0 0.3\n"
     "EDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\nEDGE_SE2 1 2 1 0 0 100 0 0 100 0 100\n"
     "EDGE_PRIOR_SE2 0 0 0 0.0 0 0 0 0 0 10\nEDGE_PRIOR_SE2 1 0 0 0.01 0 0 0 0 0 10\n"
     "EDGE_PRIOR_SE2 2 0 0 -0.01 0 0 0 0 0 10\n"},
    {"gravity",
     "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 0 0 0 0 0.1 0 0 0.99498743710662\n"
     "VERTEX_SE3:QUAT 1 1 0 0 0.1 0 0 0.99498743710662\n"
     "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 100 0 0 0 0 0 100 0 0 0 0 100 0 0 0 100 0 0 100 0 100\n"
     "EDGE_SE3_PRIOR 0 0 0 0 0 0 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 10 0 0 10 0 0\n"
     "EDGE_SE3_PRIOR 1 0 0 0 0 0 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 10 0 0 10 0 0\n"},
    {"a known landmark",
     "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nVERTEX_XY 5 1 1\nEDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\n"
     "EDGE_SE2_XY 0 5 1 1 1 0 1\nEDGE_SE2_XY 1 5 0 1 1 0 1\nEDGE_PRIOR_XY 5 7 8 1 0 1\n"},
    {"the only free point has an open depth",
     "VERTEX_SE3:EXPMAP 0 1 0 0 0 0 0 1\nFIX 0\nVERTEX_TRACKXYZ 1 1.1 0.1 2\n"
     "EDGE_SE3_PROJECT_XYZ:EXPMAP 1 0 0.6 0.5 1 0 1\n"},
    {"the same before a camera with intrinsics of its own",
     "VERTEX_CAMERA:BAL 0 0 0 0 0 0 0 500 0 0\nFIX 0\nVERTEX_TRACKXYZ 1 1.1 0.1 -5\nEDGE_PROJECT_BAL 0 1 100 0 1 0 "
     "1\n"},
    {"the only free pose is measured in part", "VERTEX_SE2 1 0.1 0.2 0\nEDGE_PRIOR_SE2 1 1 1 1 1 0 0 0 0 0\n"},
};

TEST(GaugeHolds, LoseNoMinimum) {
  const auto registry = builtinRegistry();
  for (const World& world : worlds) {
    const Graph start = readGraphText(world.text, "world", registry);
    Graph damped(start);
    const double best = optimize(damped, {.algorithm = "lm"}).finalChi2;
    for (const char* algorithm : {"auto", "gn", "dogleg", "lm"}) {
      Graph graph(start);
      const Summary summary = optimize(graph, {.algorithm = algorithm, .gauge = GaugePolicy::fix});
      EXPECT_NEAR(summary.finalChi2, best, 1e-7 * (1.0 + best))
          << world.name << ", " << algorithm << ": " << summary.reason << "; " << summary.gauge.reason;
      EXPECT_EQ(summary.gauge.free, 0) << world.name;
    }
  }
}

TEST(GaugeHolds, AreAsManyDirectionsAsAreFree) {
  const auto registry = builtinRegistry();
  for (const World& world : worlds) {
    Graph graph = readGraphText(world.text, "world", registry);
    const Problem problem(graph, {});
    for (const ComponentGauge& gauge : findGauges(problem)) {
      int held = 0;
      for (const HeldDirections& hold : gauge.holds) held += std::popcount(hold.directions);
      EXPECT_GT(gauge.free, 0) << world.name;
      EXPECT_EQ(held, gauge.free) << world.name;
    }
  }
}

TEST(GaugeHolds, AreNamed) {
  Graph graph = readGraphText(worlds[1].text, "world", builtinRegistry());
  EXPECT_EQ(optimize(graph).gauge.reason, "2 directions are free; vertex 0 in x [m], y [m] held");
}

}  // namespace
}  // namespace quiver
