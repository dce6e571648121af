#include <quiver/initialization/spanning_tree.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/util/error.h>
#include <quiver/plugins/builtin.h>
#include <quiver/types_slam2d/addons/edge_segment2d.h>
#include <quiver/types_slam2d/edge_se2.h>
#include <quiver/types_slam2d/edge_se2_xy.h>
#include <quiver/types_slam2d/register.h>
#include <quiver/types_slam3d/addons/vertex_line3d.h>
#include <quiver/types_slam3d/register.h>

namespace quiver {
namespace {

using ::testing::HasSubstr;
using Information = Matrix<double, 3, 3>;

/// A point that ranges alone tell nothing about.
class VertexMark : public BaseVertex<VertexMark, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
};
class EdgeDistance : public BaseEdge<EdgeDistance, 1, double, VertexSE2, VertexMark> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& range, const SE2<S>& robot, const Vector<S, 2>& mark) {
    return Vector<S, 1>((mark - robot.translation()).norm() - range);
  }
};
/// A pose that is known outright.
class EdgeKnownPose : public BaseEdge<EdgeKnownPose, 3, SE2<double>, VertexSE2> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const SE2<S>& z, const SE2<S>& x) {
    return (z.inverse() * x).toVector();
  }
  static bool initialEstimate(int, const SE2<double>& z, SE2<double>& x) {
    x = z;
    return true;
  }
};
/// The third mark is the sum of the others.
class EdgeSum : public BaseEdge<EdgeSum, 2, double, VertexMark, VertexMark, VertexMark> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const S& factor, const Vector<S, 2>& a, const Vector<S, 2>& b,
                                   const Vector<S, 2>& c) {
    return Vector<S, 2>(factor * (a + b) - c);
  }
  static bool initialEstimate(int to, double factor, Vector<double, 2>& a, Vector<double, 2>& b, Vector<double, 2>& c) {
    if (to != 2) return false;
    c = factor * (a + b);
    return true;
  }
};

/// How far a line passes from the origin.
class EdgeLineDistance : public BaseEdge<EdgeLineDistance, 1, double, VertexLine3D> {
 public:
  template <typename S>
  static Vector<S, 1> computeError(const S& distance, const Vector<S, 6>& line) {
    return Vector<S, 1>(line[0] * line[0] + line[1] * line[1] + line[2] * line[2] - distance * distance);
  }
};

std::shared_ptr<Registry> makeRegistry() {
  auto registry = std::make_shared<Registry>();
  registerSlam2d(*registry);
  registerSlam3d(*registry);
  registerLinearSystems(*registry);
  registry->addVertex<VertexMark>("VERTEX_MARK");
  registry->addEdge<EdgeDistance>("EDGE_DISTANCE");
  registry->addEdge<EdgeKnownPose>("EDGE_KNOWN_POSE");
  registry->addEdge<EdgeSum>("EDGE_SUM");
  registry->addEdge<EdgeLineDistance>("EDGE_LINE_DISTANCE");
  return registry;
}

void step(Graph& graph, std::int64_t from, std::int64_t to, double x, double weight) {
  graph.addEdge<EdgeSE2>({from, to}, SE2<double>(x, 0.0, 0.0), weight * Information::Identity());
}
double xOf(const Graph& graph, std::int64_t id) { return graph.vertex<VertexSE2>(id).estimate().translation()[0]; }

TEST(SpanningTree, FollowsThePathOfLeastVariance) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 4; ++id) graph.addVertex<VertexSE2>(id);
  step(graph, 0, 3, 100.0, 1.0);  // variance 3
  step(graph, 0, 1, 1.0, 4.0);    // three times 0.75
  step(graph, 2, 1, -1.0, 4.0);   // against its direction
  step(graph, 2, 3, 1.0, 4.0);
  EXPECT_THAT(spanningTreeEstimate(graph), HasSubstr("tells 3 vertices, from vertex 0"));
  for (int id = 0; id < 4; ++id) EXPECT_EQ(xOf(graph, id), id);
}

TEST(SpanningTree, PrefersFewerEdgesAmongEqualPaths) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 3; ++id) graph.addVertex<VertexSE2>(id);
  step(graph, 0, 1, 1.0, 4.0);
  step(graph, 1, 2, 1.0, 4.0);
  step(graph, 0, 2, 50.0, 2.0);
  spanningTreeEstimate(graph);
  EXPECT_EQ(xOf(graph, 2), 50.0);
}

TEST(SpanningTree, TakesEdgesWithoutInformationLast) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 4; ++id) graph.addVertex<VertexSE2>(id);
  step(graph, 0, 2, 50.0, 0.0);
  graph.addEdge<EdgeSE2>({0, 3}, SE2<double>(60.0, 0.0, 0.0), Vector<double, 3>(1e6, 1e6, 0.0).asDiagonal());
  step(graph, 0, 1, 1.0, 1e-3);
  step(graph, 1, 2, 1.0, 1e-3);
  step(graph, 2, 3, 1.0, 1e-3);
  spanningTreeEstimate(graph);
  EXPECT_EQ(xOf(graph, 2), 2.0);
  EXPECT_EQ(xOf(graph, 3), 3.0);
}

TEST(SpanningTree, HeldVerticesKeepTheirEstimatesAndAreRoots) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 5; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(0.1 * id, 0.3, 0.0));
  graph.vertex<VertexSE2>(2).setFixed(true);
  graph.vertex<VertexSE2>(4).setFixedDirections(1);
  for (int id = 0; id < 4; ++id) step(graph, id, id + 1, 1.0, 1.0);
  const std::string sentence = spanningTreeEstimate(graph);
  EXPECT_THAT(sentence, HasSubstr("from vertices 2, 4"));
  EXPECT_EQ(xOf(graph, 2), 0.1 * 2);
  EXPECT_EQ(xOf(graph, 4), 0.1 * 4);
  EXPECT_EQ(xOf(graph, 0), 0.1 * 2 - 2.0);
  EXPECT_EQ(xOf(graph, 3), 0.1 * 2 + 1.0);
}

TEST(SpanningTree, FullPriorsAreRoots) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 3; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(-7.0, 0.0, 0.0));
  step(graph, 0, 1, 1.0, 1.0);
  step(graph, 1, 2, 1.0, 1.0);
  graph.addEdge<EdgeKnownPose>({2}, SE2<double>(12.0, 0.0, 0.0), Information::Identity());
  graph.addEdge<EdgeKnownPose>({0}, SE2<double>(99.0, 0.0, 0.0), Vector<double, 3>(1.0, 1.0, 0.0).asDiagonal());
  spanningTreeEstimate(graph);
  for (int id = 0; id < 3; ++id) EXPECT_EQ(xOf(graph, id), 10.0 + id);
}

TEST(SpanningTree, EveryComponentHasARootOfLargestDimension) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexXY>(0);
  for (int id = 1; id < 5; ++id) graph.addVertex<VertexSE2>(id);
  graph.vertex<VertexSE2>(3).setEstimate(SE2<double>(5.0, 0.0, 0.0));
  step(graph, 1, 2, 1.0, 1.0);
  graph.addEdge<EdgeSE2XY>({1, 0}, Vector<double, 2>(0.0, 2.0), Matrix<double, 2, 2>::Identity());
  step(graph, 4, 3, -1.0, 1.0);
  EXPECT_THAT(spanningTreeEstimate(graph), HasSubstr("from vertices 1, 3"));
  EXPECT_EQ(graph.vertex<VertexXY>(0).estimate()[1], 2.0);
  EXPECT_EQ(xOf(graph, 2), 1.0);
  EXPECT_EQ(xOf(graph, 4), 6.0);
}

TEST(SpanningTree, GrowsFromWhatHasAnEstimate) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexSE2>(0);
  for (int id = 1; id < 3; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(4.0 + id, 5.0, 0.0));
  for (int id = 0; id < 2; ++id) step(graph, id, id + 1, 1.0, 1.0);
  EXPECT_THAT(spanningTreeEstimate(graph), HasSubstr("from vertex 1"));
  for (int id = 0; id < 3; ++id) EXPECT_EQ(xOf(graph, id), 4.0 + id);
  EXPECT_EQ(graph.vertex<VertexSE2>(0).estimate().translation()[1], 5.0);

  // Fixed where nobody knows is no reason either.
  graph.vertex<VertexSE2>(0).setHasEstimate(false);
  graph.vertex<VertexSE2>(0).setFixed(true);
  spanningTreeEstimate(graph);
  for (int id = 0; id < 3; ++id) EXPECT_EQ(xOf(graph, id), 4.0 + id);
}

TEST(SpanningTree, GrowsFromAPoseRatherThanALargerLandmark) {
  for (const bool known : {true, false}) {
    Graph graph(makeRegistry());
    graph.addVertex<VertexSE2>(0);
    if (known) graph.vertex<VertexSE2>(0).setEstimate(SE2<double>(5.0, 5.0, 0.0));
    graph.addVertex<VertexSegment2D>(5);
    graph.addEdge<EdgeSE2Segment2D>({0, 5}, Vector<double, 4>(1.0, 1.0, 1.0, 3.0), Matrix<double, 4, 4>::Identity());
    EXPECT_THAT(spanningTreeEstimate(graph), HasSubstr("tells 1 vertex, from vertex 0"));
    const double at = known ? 5.0 : 0.0;
    EXPECT_EQ(xOf(graph, 0), at);
    EXPECT_EQ(graph.vertex<VertexSegment2D>(5).estimate(), (Vector<double, 4>(at + 1, at + 1, at + 1, at + 3)));
  }
}

TEST(SpanningTree, APoseAtTheOriginTellsLandmarksThatCannotTellIt) {
  Graph graph(makeRegistry());
  graph.addVertex<VertexXY>(0, Vector<double, 2>(8.0, 8.0));
  for (int id = 1; id < 3; ++id) graph.addVertex<VertexSE2>(id);
  step(graph, 1, 2, 1.0, 1.0);
  graph.addEdge<EdgeSE2XY>({1, 0}, Vector<double, 2>(0.0, 2.0), Matrix<double, 2, 2>::Identity());
  EXPECT_THAT(spanningTreeEstimate(graph), HasSubstr("tells 2 vertices, from vertex 1"));
  EXPECT_EQ(xOf(graph, 2), 1.0);
  EXPECT_EQ(graph.vertex<VertexXY>(0).estimate(), (Vector<double, 2>(0.0, 2.0)));
}

void expectUntold(Graph& graph, const std::string& vertex) {
  try {
    spanningTreeEstimate(graph);
    FAIL() << vertex;
  } catch (const GraphError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no edge tells where vertex " + vertex));
  }
}

TEST(SpanningTree, NoOriginStandsForWhatNothingTells) {
  Graph segment(makeRegistry());
  segment.addVertex<VertexSE2>(0, SE2<double>());
  segment.addVertex<VertexSegment2D>(5);
  segment.addEdge<EdgeSE2Segment2DLine>({0, 5}, Vector<double, 2>(0.0, 2.0), Matrix<double, 2, 2>::Identity());
  expectUntold(segment, "5 (VERTEX_SEGMENT2D)");
  EXPECT_FALSE(segment.findVertex(5)->hasEstimate());

  Graph line(makeRegistry());
  line.addVertex<VertexLine3D>(5);
  line.addEdge<EdgeLineDistance>({5}, 2.0, Matrix<double, 1, 1>::Identity());
  expectUntold(line, "5 (VERTEX_LINE3D)");
  EXPECT_FALSE(line.findVertex(5)->hasEstimate());
}

TEST(SpanningTree, EdgesOfManyVerticesTellTheLastUnknown) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 3; ++id) graph.addVertex<VertexMark>(id);
  for (int id = 0; id < 2; ++id) {
    graph.vertex<VertexMark>(id).setEstimate(Vector<double, 2>(1.0 + id, 0.0));
    graph.vertex<VertexMark>(id).setFixed(true);
  }
  graph.addEdge<EdgeSum>({0, 1, 2}, 10.0, Matrix<double, 2, 2>::Identity());
  spanningTreeEstimate(graph);
  EXPECT_EQ(graph.vertex<VertexMark>(2).estimate()[0], 30.0);
}

TEST(SpanningTree, NamesVerticesThatNoEdgeTells) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 2; ++id) graph.addVertex<VertexSE2>(id);
  graph.addVertex<VertexMark>(7);
  graph.addVertex<VertexMark>(8);
  step(graph, 0, 1, 1.0, 1.0);
  for (const std::int64_t mark : {7, 8}) graph.addEdge<EdgeDistance>({1, mark}, 4.0, Matrix<double, 1, 1>::Identity());
  try {
    spanningTreeEstimate(graph);
    FAIL();
  } catch (const GraphError& error) {
    EXPECT_THAT(error.what(), HasSubstr("vertex 7 (VERTEX_MARK)"));
    EXPECT_THAT(error.what(), HasSubstr("nor 1 other:"));
  }
  graph.vertex<VertexMark>(7).setEstimate(Vector<double, 2>(1.0, 2.0));
  graph.vertex<VertexMark>(8).setEstimate(Vector<double, 2>(3.0, 4.0));
  EXPECT_THAT(spanningTreeEstimate(graph), HasSubstr("2 others, which keep their estimate (vertex 7, VERTEX_MARK"));
  EXPECT_EQ(graph.vertex<VertexMark>(8).estimate()[1], 4.0);
}

TEST(SpanningTree, MovesOnlyTheVerticesAskedFor) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 4; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(-1.0 - id, 0.0, 0.0));
  for (int id = 0; id < 3; ++id) step(graph, id, id + 1, 1.0, 1.0);
  spanningTreeEstimate(graph, {.free = {2}});
  EXPECT_EQ(xOf(graph, 1), -2.0);
  EXPECT_EQ(xOf(graph, 2), -1.0);
  EXPECT_EQ(xOf(graph, 3), -4.0);
}

TEST(SpanningTree, TheOrderOfInsertionDoesNotMatter) {
  constexpr int poses = 60;
  std::vector<double> reference;
  for (unsigned seed = 0; seed < 4; ++seed) {
    std::mt19937 shuffle(seed);
    Graph graph(makeRegistry());
    std::vector<int> ids(poses);
    std::iota(ids.begin(), ids.end(), 0);
    if (seed > 0) std::shuffle(ids.begin(), ids.end(), shuffle);
    for (const int id : ids) graph.addVertex<VertexSE2>(id);
    std::vector<std::pair<int, int>> pairs;
    for (int id = 1; id < poses; ++id) {
      pairs.emplace_back(id - 1, id);
      pairs.emplace_back(id / 2, id + (id / 2 == id - 1));
    }
    std::erase_if(pairs, [](const auto& p) { return p.second >= poses || p.first == p.second; });
    if (seed > 0) std::shuffle(pairs.begin(), pairs.end(), shuffle);
    for (const auto& [from, to] : pairs)
      graph.addEdge<EdgeSE2>({from, to}, SE2<double>(0.1 * from, 0.3 * to, 0.01 * to), Information::Identity());
    spanningTreeEstimate(graph);
    std::vector<double> values;
    for (int id = 0; id < poses; ++id) {
      values.push_back(xOf(graph, id));
      values.push_back(graph.vertex<VertexSE2>(id).estimate().angle());
    }
    if (seed == 0) reference = values;
    EXPECT_EQ(values, reference);
  }
}

TEST(Odometry, FollowsConsecutiveIdsFirst) {
  Graph graph(makeRegistry());
  for (int id = 0; id < 4; ++id) graph.addVertex<VertexSE2>(id);
  graph.addVertex<VertexSE2>(10);
  for (int id = 0; id < 3; ++id) step(graph, id, id + 1, 1.0, 1e-6);
  step(graph, 0, 3, 100.0, 1e6);
  step(graph, 3, 10, 5.0, 1.0);
  EXPECT_THAT(odometryEstimate(graph), HasSubstr("the odometry tells 4 vertices"));
  EXPECT_EQ(xOf(graph, 3), 3.0);
  EXPECT_EQ(xOf(graph, 10), 8.0);
}

/// The published graphs beside the checkout, or where QUIVER_DATA points.
std::filesystem::path dataFolder() {
  if (const char* folder = std::getenv("QUIVER_DATA")) return folder;
  for (std::filesystem::path folder = std::filesystem::current_path();; folder = folder.parent_path()) {
    if (std::filesystem::exists(folder / "shared/data")) return folder / "shared/data";
    if (folder == folder.parent_path()) return {};
  }
}

struct Published {
  const char* file;
  double best;
};
class SpanningTreeStart : public ::testing::TestWithParam<Published> {};

/// Graphs whose file holds no start, or one from which descent ends in another minimum: the tree leads to the best
/// known.
TEST_P(SpanningTreeStart, LeadsToTheBestKnownOptimum) {
  const std::filesystem::path file = dataFolder() / GetParam().file;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no published graphs beside this checkout";
  Graph graph = readGraph(file.string(), makeRegistry());
  spanningTreeEstimate(graph);
  const Summary summary = optimize(graph);
  EXPECT_EQ(summary.status, Status::converged) << summary.reason;
  EXPECT_NEAR(summary.finalChi2, GetParam().best, 1e-6 * GetParam().best) << "from " << summary.initialChi2;
}

INSTANTIATE_TEST_SUITE_P(Graphs, SpanningTreeStart,
                         ::testing::Values(Published{"manhattan.g2o", 3549.036796}, Published{"MIT.g2o", 41.16326884},
                                           Published{"intel_odometry.g2o", 215.8302349},
                                           Published{"torus3D.g2o", 14574.74644}),
                         [](const auto& info) { return std::filesystem::path(info.param.file).stem().string(); });

}  // namespace
}  // namespace quiver
