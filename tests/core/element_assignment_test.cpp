// Elements are values in what they say, and stay where they are in what they belong to.
#include <gtest/gtest.h>
#include <quiver/core/algorithm/optimizer.h>
#include <quiver/core/graph/robust_kernels.h>

#include "ring_graph.h"

namespace quiver {
namespace {

using namespace test;

Graph twoPoints() {
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(1, Vector<double, 2>(1.0, 2.0));
  graph.addVertex<VertexPoint>(2, Vector<double, 2>(3.0, 4.0));
  graph.addEdge<EdgePoint>({1}, Vector<double, 2>(0.0, 0.0), weight2(1.0));
  graph.addEdge<EdgePoint>({2}, Vector<double, 2>(5.0, 5.0), weight2(2.0));
  return graph;
}

std::vector<EdgePoint*> edgesOf(Graph& graph) {
  std::vector<EdgePoint*> edges;
  graph.forEachEdge([&](Edge& edge) { edges.push_back(static_cast<EdgePoint*>(&edge)); });
  return edges;
}

TEST(ElementAssignment, VerticesKeepTheirIds) {
  Graph graph = twoPoints();
  graph.vertex<VertexPoint>(1).setFixed(true);
  graph.vertex<VertexPoint>(2) = graph.vertex<VertexPoint>(1);
  const auto& two = graph.vertex<VertexPoint>(2);
  EXPECT_EQ(two.id(), 2);
  EXPECT_EQ(two.estimate(), (Vector<double, 2>(1.0, 2.0)));
  EXPECT_TRUE(two.fixed());
  EXPECT_EQ(optimize(graph).status, Status::nothingToOptimise);
}

TEST(ElementAssignment, EdgesKeepTheirVertices) {
  Graph graph = twoPoints();
  const auto edges = edgesOf(graph);
  edges[1]->setRobustKernel(RobustKernelHuber(0.5));
  edges[1]->setLevel(3);
  const EdgePoint saved = *edges[1];
  *edges[0] = saved;
  EXPECT_EQ(edges[0]->vertexId(0), 1);
  EXPECT_EQ(edges[0]->measurement(), (Vector<double, 2>(5.0, 5.0)));
  EXPECT_EQ(edges[0]->information(), weight2(2.0));
  EXPECT_EQ(edges[0]->robustKernel().name(), "Huber");
  EXPECT_EQ(edges[0]->level(), 3);
  // Both can still be removed, each once.
  graph.removeEdge(*edges[0]);
  EXPECT_EQ(graph.edgeCount(), 1);
  graph.removeVertex(2);
  EXPECT_EQ(graph.edgeCount(), 0);
  EXPECT_EQ(graph.vertexCount(), 1);
}

TEST(ElementAssignment, IsSeenByAnOptimizer) {
  Graph graph = twoPoints();
  const auto edges = edgesOf(graph);
  const EdgePoint saved = *edges[0];
  Optimizer optimizer;
  (void)optimizer.optimize(graph);
  edges[0]->setMeasurement(Vector<double, 2>(9.0, 9.0));
  (void)optimizer.optimize(graph);
  EXPECT_NEAR(graph.vertex<VertexPoint>(1).estimate()[0], 9.0, 1e-12);
  *edges[0] = saved;  // whose count of changes is that of the first call
  (void)optimizer.optimize(graph);
  EXPECT_TRUE(optimizer.reused());
  EXPECT_NEAR(graph.vertex<VertexPoint>(1).estimate()[0], 0.0, 1e-12);
}

TEST(ElementAssignment, ParametersKeepTheirIds) {
  Graph graph(makeRegistry());
  auto& one = graph.addParameter<ParameterShift>(1, Vector<double, 2>(1.0, 0.0));
  auto& two = graph.addParameter<ParameterShift>(2, Vector<double, 2>(0.0, 7.0));
  one = two;
  EXPECT_EQ(one.id(), 1);
  EXPECT_EQ(one.value(), (Vector<double, 2>(0.0, 7.0)));
}

TEST(ElementAssignment, ARemovedPlaceIsBlank) {
  Graph graph = twoPoints();
  const auto edges = edgesOf(graph);
  edges[1]->setRobustKernel(RobustKernelHuber(0.5));
  edges[1]->setLevel(3);
  graph.vertex<VertexPoint>(2).setFixed(true);
  graph.removeVertex(2);
  const VertexPoint& vertex = graph.addVertex<VertexPoint>(5);
  EXPECT_FALSE(vertex.hasEstimate());
  EXPECT_FALSE(vertex.fixed());
  const EdgePoint& edge = graph.addEdge<EdgePoint>({5}, Vector<double, 2>(1.0, 1.0), weight2());
  EXPECT_EQ(&edge, edges[1]);
  EXPECT_FALSE(edge.robustKernel());
  EXPECT_EQ(edge.level(), 0);
}

}  // namespace
}  // namespace quiver
