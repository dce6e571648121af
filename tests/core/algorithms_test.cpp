// Algorithms by name: those of the library, and one that somebody registers.
#include <quiver/core/algorithm/algorithms.h>

#include <functional>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/descent.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Range = EdgeRangeAnalyticLanes;

/// Full steps, one factorisation each.
void plainSteps(Descent& descent) {
  while (!descent.exhausted()) {
    const LinearOutcome outcome = descent.system().solve({}, descent.delta(), descent.stop());
    if (!outcome.ok()) return descent.fail(outcome);
    if (descent.accept(descent.tryStep())) return;
  }
}

/// The ring, its registry filled further.
Graph ringWith(const std::function<void(Registry&)>& fill) {
  Graph graph = ringGraph<Range>(20, 4);
  fill(const_cast<Registry&>(*graph.registry()));
  return graph;
}

TEST(Algorithms, OfTheLibraryAreRegisteredOnce) {
  const auto registry = builtinRegistry();
  EXPECT_THAT(algorithmNames(*registry), ElementsAre("auto", "gn", "lm", "dogleg"));
  EXPECT_THROW(registerAlgorithms(*registry), GraphError);
  EXPECT_THROW(registry->addAlgorithm("auto", "", {plainSteps, false}), GraphError);
  EXPECT_THROW(registry->addAlgorithm("two words", "", {plainSteps, false}), GraphError);
  EXPECT_THROW(registry->addAlgorithm("empty", "", {}), GraphError);
  EXPECT_THROW(registry->addInitializer("empty", "", {}), GraphError);
  EXPECT_THROW(registry->addInitializer("file", "", [](Graph&, const Options&) { return std::string(); }), GraphError);
  EXPECT_THROW(registry->addLinearSystem("empty", "", {}), GraphError);
  EXPECT_THROW(registry->add(std::unique_ptr<VertexType>()), GraphError);
  for (const char* tag : {"VERTEX,POINT", "\"VERTEX"}) EXPECT_THROW(Registry().addVertex<VertexSE2>(tag), GraphError);
  EXPECT_EQ(findAlgorithm(*registry, "LM"), registry->findAlgorithm("lm")) << "without regard to case";
  EXPECT_TRUE(registry->findAlgorithm("lm")->value.damped);
  EXPECT_EQ(findAlgorithm(*registry, "newton"), nullptr);
  // A registry that was filled by hand knows them too.
  EXPECT_NE(findAlgorithm(Registry(), "dogleg"), nullptr);
}

TEST(Algorithms, OfSomebodyElseIsRun) {
  const auto fill = [](Registry& registry) { registry.addAlgorithm("plain", "", {plainSteps, false}); };
  Graph graph = ringWith(fill);
  Graph twin(graph);
  const Summary summary = optimize(graph, {.algorithm = "Plain"});
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_EQ(summary.plan.algorithm, "plain");
  EXPECT_EQ(summary.gauge.free, 0) << "steps are not damped, so a vertex is held";
  EXPECT_NEAR(summary.finalChi2, optimize(twin, {.algorithm = "gn"}).finalChi2, 1e-9 * summary.finalChi2);
}

TEST(Algorithms, SayWhetherTheGaugeMayStayFree) {
  const auto fill = [](Registry& registry) {
    registry.addAlgorithm("damped", "", {levenbergMarquardt, true});
    registry.addAlgorithm("idle", "", {[](Descent&) {}, true});
  };
  Graph graph = ringWith(fill);
  EXPECT_EQ(optimize(graph, {.algorithm = "damped"}).gauge.free, 3);
  const Summary summary = optimize(graph, {.algorithm = "idle"});
  EXPECT_EQ(summary.status, Status::stalled);
  EXPECT_THAT(summary.reason, HasSubstr("without saying why"));
  EXPECT_EQ(summary.finalChi2, summary.initialChi2);
}

TEST(Algorithms, UnknownOnesAreNamedWithThoseThereAre) {
  const auto fill = [](Registry& registry) { registry.addAlgorithm("plain", "", {plainSteps, false}); };
  Graph graph = ringWith(fill);
  try {
    (void)optimize(graph, {.algorithm = "newton"});
    FAIL() << "no such algorithm";
  } catch (const GraphError& error) {
    EXPECT_STREQ(error.what(), "no algorithm 'newton'; there are auto, gn, lm, dogleg, plain");
  }
}

/// What was not chosen is not told.
TEST(Summary, OfAnEmptyGraphNamesNoSolver) {
  Graph graph(builtinRegistry());
  std::ostringstream text;
  text << optimize(graph);
  EXPECT_EQ(text.str().find("linear solver"), std::string::npos) << text.str();
}

}  // namespace
}  // namespace quiver
