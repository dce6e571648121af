#include <quiver/initialization/automatic.h>

#include <gtest/gtest.h>

#include <quiver/quiver.h>

namespace quiver::test {
namespace {

/// A square loop of planar poses whose estimates are off the truth by `offset` metres in x, alternately.
Graph squareLoop(double offset) {
  Graph graph(builtinRegistry());
  constexpr int poses = 16;
  for (int i = 0; i < poses; ++i) {
    const double side = i / 4;
    const double along = i % 4;
    const double x = side == 0 ? along : side == 1 ? 4.0 : side == 2 ? 4.0 - along : 0.0;
    const double y = side == 0 ? 0.0 : side == 1 ? along : side == 2 ? 4.0 : 4.0 - along;
    graph.addVertex<VertexSE2>(i, SE2<double>(x, y, 0.5 * M_PI * side));
  }
  const auto pose = [&](int i) {
    return static_cast<const VertexSE2&>(*std::as_const(graph).findVertex(i)).estimate();
  };
  for (int i = 0; i < poses; ++i) {
    const int j = (i + 1) % poses;
    graph.addEdge<EdgeSE2>({i, j}, pose(i).inverse() * pose(j),
                           Matrix<double, 3, 3>(100.0 * Matrix<double, 3, 3>::Identity()));
  }
  for (int i = 0; i < poses; ++i) {
    auto& vertex = static_cast<VertexSE2&>(*graph.findVertex(i));
    const SE2<double> x = vertex.estimate();
    vertex.setEstimate(
        SE2<double>(x.translation()[0] + (i % 2 == 0 ? offset : -offset), x.translation()[1], x.angle()));
  }
  graph.findVertex(0)->setFixed(true);
  return graph;
}

TEST(AutomaticStart, keepsEstimatesWithinTheNoise) {
  Graph graph = squareLoop(0.01);  // χ² of an edge at most 100 · 0.02² = 0.04; 3 numbers too many in all
  const AutomaticStart start = automaticStart(graph);
  EXPECT_EQ(start.name, "file");
  EXPECT_NE(start.reason.find("within the noise of 3 redundant measurements"), std::string::npos) << start.reason;
  EXPECT_EQ(static_cast<const VertexSE2&>(*std::as_const(graph).findVertex(1)).estimate().translation()[0], 1.0 - 0.01);
}

TEST(AutomaticStart, looksForABetterStartBeyondTheNoise) {
  Graph graph = squareLoop(0.5);
  const AutomaticStart start = automaticStart(graph);
  EXPECT_EQ(start.name, "chordal") << start.reason;
}

/// A position seen from a pose, whose initial estimate fails as no library would.
class EdgeThrowing : public BaseEdge<EdgeThrowing, 2, Vector<double, 2>, VertexSE2, VertexXY> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& pose, const Vector<S, 2>& point) {
    return pose.actInverse(point) - z;
  }
  static bool initialEstimate(int, const Vector<double, 2>&, SE2<double>&, Vector<double, 2>&) {
    throw std::runtime_error("no luck");
  }
};

TEST(AutomaticStart, whatAGuessThrowsCostsNoEstimate) {
  Graph loop = squareLoop(0.5);
  auto registry = builtinRegistry();
  registry->addEdge<EdgeThrowing>("EDGE_THROWING");
  Graph graph(registry);
  loop.forEachVertex([&](const Vertex& vertex) {
    graph.addVertex<VertexSE2>(vertex.id(), static_cast<const VertexSE2&>(vertex).estimate());
  });
  loop.forEachEdge([&](const Edge& edge) {
    const auto& typed = static_cast<const EdgeSE2&>(edge);
    graph.addEdge<EdgeSE2>(edge.vertexIds(), typed.measurement(), typed.information());
  });
  graph.findVertex(0)->setFixed(true);
  graph.addVertex<VertexXY>(100, Vector<double, 2>(5.0, 6.0));
  graph.addEdge<EdgeThrowing>({3, 100}, Vector<double, 2>(1.0, 1.0), Matrix<double, 2, 2>::Identity());
  EXPECT_THROW((void)automaticStart(graph), std::runtime_error);
  EXPECT_EQ(graph.vertex<VertexXY>(100).estimate(), (Vector<double, 2>(5.0, 6.0)));
  EXPECT_TRUE(graph.findVertex(100)->hasEstimate());
  for (int i = 0; i < 16; ++i)
    EXPECT_EQ(graph.vertex<VertexSE2>(i).estimate().x(), loop.vertex<VertexSE2>(i).estimate().x()) << i;
}

}  // namespace
}  // namespace quiver::test
