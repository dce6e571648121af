// What #quiver lines say is what a reader understands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/io/g2o/g2o_reader.h>
#include <quiver/core/io/g2o/g2o_writer.h>
#include <quiver/core/util/error.h>
#include <tests/io/graph_types.h>

namespace quiver {
namespace {

using test::Odometry2;
using test::Point2;
using test::Pose2;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

RobustValue identity(double squaredError, double, double) { return {squaredError, 1.0, 0.0}; }

Graph twoPoses() {
  Graph graph(test::makeRegistry());
  graph.addVertex<Pose2>(1, SE2<double>(0.5, 0.0, 0.0));
  graph.addVertex<Pose2>(2, SE2<double>(0.7, 0.0, 0.0));
  graph.addEdge<Odometry2>({1, 2}, SE2<double>(1, 2, 3), Matrix<double, 3, 3>::Identity());
  return graph;
}

TEST(G2oMarks, DirectionsBeyondTheDimensionAreNotWritten) {
  Graph graph = twoPoses();
  graph.vertex<Pose2>(1).setFixedDirections(0xF0);
  graph.vertex<Pose2>(2).setFixedDirections(0xF2);
  const std::string text = graphText(graph);
  EXPECT_THAT(text, HasSubstr("#quiver fixed 1\n"));
  const Graph back = readGraphText(text, "a.g2o", graph.registry());
  EXPECT_EQ(back.vertex<Pose2>(1).fixedDirections(), 0U);
  EXPECT_EQ(back.vertex<Pose2>(2).fixedDirections(), 2U);
  graph.vertex<Pose2>(1).setFixedDirections(0xF7);
  EXPECT_THAT(graphText(graph), HasSubstr("FIX 1\n"));
}

TEST(G2oMarks, AKernelNoReaderWouldKnowIsRefused) {
  Graph graph = twoPoses();
  static const RobustKernelType own{"Own", identity, "none"};
  graph.forEachEdge([](Edge& edge) { edge.setRobustKernel(RobustKernel(own, 1.0)); });
  EXPECT_THAT([&] { (void)graphText(graph); },
              ThrowsMessage<GraphError>(HasSubstr("1 2: robust kernel 'Own' is not of the graph's registry")));
  // Another kernel of a name that is known is not the same.
  static const RobustKernelType impostor{"Huber", identity, "none"};
  graph.forEachEdge([](Edge& edge) { edge.setRobustKernel(RobustKernel(impostor, 1.0)); });
  EXPECT_THROW((void)graphText(graph), GraphError);
}

TEST(G2oMarks, KernelsHaveNamesOfOneWord) {
  Registry registry;
  for (const char* name : {"", "two words", "tab\tbed", "none", "None"}) {
    const RobustKernelType kernel{name, identity, ""};
    EXPECT_THROW(registry.addRobustKernel(kernel), GraphError) << name;
  }
}

}  // namespace
}  // namespace quiver
