// Optimising a part of a bundle adjustment, the rest held: the same as a graph that holds the rest by FIX.
#include <gtest/gtest.h>

#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/problem/problem.h>
#include <tests/types_sba/bundle_problem.h>

namespace quiver {
namespace {

using test::BundleProblem;

Options only(std::vector<std::int64_t> free) {
  Options options;
  options.algorithm = "lm";
  // Both stop where steps vanish.
  options.costTolerance = options.gradientTolerance = 0.0;
  options.stepTolerance = 1e-13;
  options.free = std::move(free);
  return options;
}

std::vector<std::int64_t> range(std::int64_t first, int count) {
  std::vector<std::int64_t> ids;
  for (int i = 0; i < count; ++i) ids.push_back(first + i);
  return ids;
}

/// The same with all other vertices fixed, and edges that touch no free vertex on a level of their own.
Graph held(const Graph& graph, const std::vector<std::int64_t>& free) {
  Graph copy = graph;
  const auto isFree = [&](std::int64_t id) { return std::find(free.begin(), free.end(), id) != free.end(); };
  copy.forEachVertex([&](Vertex& vertex) { vertex.setFixed(!isFree(vertex.id())); });
  copy.forEachEdge([&](Edge& edge) {
    if (!isFree(edge.vertexId(0)) && !isFree(edge.vertexId(1))) edge.setLevel(1);
  });
  return copy;
}

void expectSameEstimates(const Graph& a, const Graph& b) {
  a.forEachVertex([&](const Vertex& vertex) {
    const Vertex& other = *b.findVertex(vertex.id());
    const int count = a.typeOf(vertex).valueCount(vertex);
    for (int k = 0; k < count; ++k)
      ASSERT_NEAR(a.typeOf(vertex).values(vertex)[k], b.typeOf(other).values(other)[k], 1e-9) << vertex.id();
  });
}

void check(const std::vector<std::int64_t>& free) {
  BundleProblem problem;
  problem.withPixels();
  const Graph before = problem.graph;
  Graph fixed = held(problem.graph, free);
  const Summary summary = optimize(problem.graph, only(free));
  (void)optimize(fixed, only({}));
  EXPECT_TRUE(summary.converged() || summary.status == Status::stalled) << summary.reason;
  expectSameEstimates(problem.graph, fixed);
  before.forEachVertex([&](const Vertex& vertex) {
    const Vertex& after = *problem.graph.findVertex(vertex.id());
    const int count = before.typeOf(vertex).valueCount(vertex);
    const double* x = before.typeOf(vertex).values(vertex);
    const bool same = std::equal(x, x + count, before.typeOf(after).values(after));
    EXPECT_EQ(same, std::find(free.begin(), free.end(), vertex.id()) == free.end()) << vertex.id();
    EXPECT_FALSE(after.fixed());
  });
}

TEST(PartialBundle, PointsAlone) { check(range(100, BundleProblem::points)); }
TEST(PartialBundle, OnePointAlone) { check({103}); }
TEST(PartialBundle, PosesAlone) { check(range(0, BundleProblem::poses)); }
TEST(PartialBundle, OnePoseAlone) { check({2}); }
TEST(PartialBundle, AWindow) {
  std::vector<std::int64_t> window = range(100, 12);
  window.insert(window.end(), {2, 3});
  check(window);
}

/// With exact points, each pose is found whatever the others are.
TEST(PartialBundle, MotionOnlyFindsThePose) {
  BundleProblem problem(0.0);
  problem.withPixels();
  VertexSE3& pose = problem.graph.vertex<VertexSE3>(1);
  Vector<double, 6> off;
  off << 0.2, -0.1, 0.1, 0.05, -0.05, 0.1;
  pose.setEstimate(pose.estimate().retract(off));
  (void)optimize(problem.graph, only({1}));
  EXPECT_LT(pose.estimate().localCoordinates(BundleProblem::pose(1)).norm(), 1e-10);
}

/// With exact poses, each point is found by itself.
TEST(PartialBundle, StructureOnlyFindsThePoints) {
  BundleProblem problem(0.0);
  problem.withPixels();
  for (int j = 0; j < BundleProblem::points; ++j)
    problem.graph.vertex<VertexXYZ>(100 + j).setEstimate(BundleProblem::point(j) + Vector<double, 3>(0.2, -0.1, 0.4));
  (void)optimize(problem.graph, only(range(100, BundleProblem::points)));
  for (int j = 0; j < BundleProblem::points; ++j)
    EXPECT_LT((problem.graph.vertex<VertexXYZ>(100 + j).estimate() - BundleProblem::point(j)).norm(), 1e-9) << j;
}

/// Only edges on what moves take part.
TEST(PartialBundle, CompilesWhatItNeeds) {
  BundleProblem problem;
  problem.withPixels();
  const Problem part(problem.graph, {.level = 0, .free = {2}, .threads = 1});
  EXPECT_EQ(part.edges(), BundleProblem::points);
  EXPECT_EQ(part.variables(), 1);
}

}  // namespace
}  // namespace quiver
