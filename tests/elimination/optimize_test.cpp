#include <quiver/core/algorithm/optimizer.h>

#include <algorithm>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/memory_estimate.h>
#include <quiver/core/util/error.h>

#include "projections.h"

namespace quiver::test {
namespace {

/// Rounding of chi2 through different orders of elimination.
constexpr double sameChi2 = 1e-9;

Options withTypes(std::vector<std::string> types, int threads = 1) {
  Options options;
  options.algorithm = "lm";
  options.threads = threads;
  options.elimination = types.empty() ? EliminationPolicy::none : EliminationPolicy::types;
  options.eliminatedTypes = std::move(types);
  return options;
}

TEST(Elimination, IsChosenForBundles) {
  Graph graph = bundle({});
  const Summary summary = optimize(graph, {.threads = 1});
  EXPECT_TRUE(summary.converged()) << summary.reason;
  EXPECT_EQ(summary.plan.eliminated, 200);
  ASSERT_EQ(summary.plan.eliminatedTypes.size(), 1U);
  EXPECT_EQ(summary.plan.eliminatedTypes.front(), "POINT");
  EXPECT_EQ(summary.plan.algorithm, "lm");
  EXPECT_FALSE(summary.plan.eliminationReason.empty());
}

TEST(Elimination, SaysWhyNotOfFewPoints) {
  Graph graph = bundle({.points = 12});
  const Summary summary = optimize(graph, {.maxIterations = 1, .threads = 1});
  EXPECT_EQ(summary.plan.eliminated, 0);
  EXPECT_EQ(summary.plan.eliminationReason, "vertices of no small type are as many as 16");
}

TEST(Elimination, HintsOfAnyKindLeadToTheSameOptimum) {
  Graph reference = bundle({});
  const Summary expected = optimize(reference, withTypes({}));
  ASSERT_TRUE(expected.converged()) << expected.reason;
  EXPECT_EQ(expected.plan.eliminated, 0);
  const std::vector<std::vector<std::string>> hints = {
      {"POINT"}, {"CAMERA"}, {"CAMERA", "POINT"}, {"INTRINSICS"}, {"INTRINSICS", "POINT", "CAMERA"}};
  for (const auto& hint : hints) {
    Graph graph = bundle({});
    const Summary summary = optimize(graph, withTypes(hint));
    EXPECT_TRUE(summary.converged()) << hint.front() << ": " << summary.reason;
    EXPECT_GT(summary.plan.eliminated, 0);
    EXPECT_NEAR(summary.finalChi2, expected.finalChi2, sameChi2 * expected.finalChi2) << hint.front();
  }
  Graph automatic = bundle({});
  const Summary summary = optimize(automatic, {.threads = 1});
  EXPECT_NEAR(summary.finalChi2, expected.finalChi2, sameChi2 * expected.finalChi2);
}

TEST(Elimination, EveryBackendFindsTheSameOptimum) {
  double expected = 0.0;
  for (const char* solver : {"auto", "dense", "block", "eigen", "pcg"}) {
    for (const bool eliminate : {true, false}) {
      Graph graph = bundle({});
      Options options = withTypes(eliminate ? std::vector<std::string>{"POINT"} : std::vector<std::string>{});
      options.linearSolver = solver;
      const Summary summary = optimize(graph, options);
      EXPECT_TRUE(summary.converged()) << solver << ": " << summary.reason;
      if (expected == 0.0) expected = summary.finalChi2;
      EXPECT_NEAR(summary.finalChi2, expected, sameChi2 * expected) << solver << (eliminate ? " eliminating" : "");
    }
  }
}

TEST(Elimination, AnyNumberOfThreadsGivesTheSameBits) {
  const auto run = [](int threads, const char* solver) {
    BundleShape shape;
    shape.cameras = 40;
    shape.points = 1500;
    Graph graph = bundle(shape);
    Options options = withTypes({"POINT"}, threads);
    options.maxIterations = 4;
    options.linearSolver = solver;
    const Summary summary = optimize(graph, options);
    std::vector<double> values{summary.finalChi2};
    for (int i = 0; i < shape.points; ++i) {
      const Vector<double, 3> x = graph.vertex<VertexPlace>(firstPoint + i).estimate();
      values.insert(values.end(), x.data(), x.data() + 3);
    }
    return values;
  };
  for (const char* solver : {"auto", "pcg"}) {
    const std::vector<double> one = run(1, solver);
    EXPECT_EQ(one, run(2, solver));
    EXPECT_EQ(one, run(3, solver));
  }
}

TEST(Elimination, NamesSingularPointsAndGoesOn) {
  BundleShape shape;
  shape.seenOnce = 3;
  Graph graph = bundle(shape);
  const Summary summary = optimize(graph, {.threads = 1});
  EXPECT_TRUE(summary.converged()) << summary.reason;
  EXPECT_EQ(summary.plan.singular, (std::vector<std::int64_t>{firstPoint, firstPoint + 1, firstPoint + 2}));
  for (const char* algorithm : {"gn", "lm"}) {
    Graph again = bundle(shape);
    Options options = withTypes({"POINT"});
    options.algorithm = algorithm;
    options.gauge = GaugePolicy::fix;
    const Summary other = optimize(again, options);
    EXPECT_NE(other.status, Status::numericalFailure) << algorithm << ": " << other.reason;
  }
}

TEST(Elimination, LeavesOneOfTwoJoinedPointsBehind) {
  BundleShape shape;
  shape.joinedPoints = 20;
  Graph graph = bundle(shape);
  const Summary summary = optimize(graph, {.threads = 1});
  EXPECT_TRUE(summary.converged()) << summary.reason;
  EXPECT_EQ(summary.plan.eliminated, shape.points - shape.joinedPoints);
  Graph reference = bundle(shape);
  const Summary expected = optimize(reference, withTypes({}));
  EXPECT_NEAR(summary.finalChi2, expected.finalChi2, sameChi2 * expected.finalChi2);
}

TEST(Elimination, TakesPartsOfABundle) {
  for (const bool structure : {true, false}) {
    Graph graph = bundle({});
    Graph reference = bundle({});
    Options options;
    options.threads = 1;
    if (structure) {
      for (int i = 0; i < 200; ++i) options.free.push_back(firstPoint + i);
    } else {
      options.free.push_back(3);
    }
    const Summary summary = optimize(graph, options);
    EXPECT_TRUE(summary.converged()) << summary.reason;
    EXPECT_EQ(summary.plan.eliminated, structure ? 200 : 0);
    options.elimination = EliminationPolicy::none;
    options.algorithm = "lm";
    const Summary expected = optimize(reference, options);
    EXPECT_NEAR(summary.finalChi2, expected.finalChi2, sameChi2 * expected.finalChi2);
    EXPECT_EQ(graph.vertex<VertexView>(0).estimate(), bundle({}).vertex<VertexView>(0).estimate());
  }
}

TEST(Elimination, RefusesWhatDoesNotFitMemory) {
  Graph graph = bundle({});
  const Graph before = graph;
  const std::int64_t bytes = estimateMemory(graph, {.threads = 1});
  EXPECT_GT(bytes, 100000);
  for (const std::int64_t limit : {std::int64_t{1000}, bytes / 2}) {
    const Summary summary = optimize(graph, {.threads = 1, .memoryLimit = limit});
    EXPECT_EQ(summary.status, Status::memoryLimit);
    EXPECT_TRUE(summary.iterations.empty());
    EXPECT_NE(summary.reason.find(std::to_string(limit)), std::string::npos) << summary.reason;
    EXPECT_EQ(graph.vertex<VertexView>(5).estimate(), before.vertex<VertexView>(5).estimate());
  }
  EXPECT_TRUE(optimize(graph, {.threads = 1, .memoryLimit = bytes + 1}).converged());
}

TEST(Elimination, RefusesUnknownTypes) {
  Graph graph = bundle({});
  EXPECT_THROW((void)optimize(graph, withTypes({"POINTS"})), GraphError);
}

}  // namespace
}  // namespace quiver::test
