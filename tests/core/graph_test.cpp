#include <quiver/core/graph/graph.h>

#include <array>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/util/error.h>

#include "core_types.h"

namespace quiver {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const SE2<double> unit(1.0, 0.0, 0.0);

/// Poses 0, 1, 2 in a chain.
Graph chain() {
  Graph graph(makeRegistry());
  for (int id = 0; id < 3; ++id) graph.addVertex<VertexSE2>(id, SE2<double>(id, 0.0, 0.0));
  for (int id = 0; id < 2; ++id) graph.addEdge<EdgeSE2>({id, id + 1}, unit, weight3());
  return graph;
}

TEST(Graph, RefusesBadIds) {
  Graph graph = chain();
  EXPECT_THAT([&] { graph.addVertex<VertexSE2>(1); }, ThrowsMessage<GraphError>(HasSubstr("vertex 1 exists already")));
  EXPECT_THAT([&] { graph.addVertex<VertexSE2>(-4); }, ThrowsMessage<GraphError>(HasSubstr("-4 is negative")));
  EXPECT_THAT([&] { graph.vertex<VertexSE2>(77); }, ThrowsMessage<GraphError>(HasSubstr("77")));
  EXPECT_THAT([&] { graph.vertex<VertexPoint>(1); }, ThrowsMessage<GraphError>(HasSubstr("VERTEX_SE2")));
  EXPECT_EQ(graph.findVertex(77), nullptr);
  EXPECT_EQ(graph.vertexCount(), 3);
}

TEST(Graph, TakesIdsOfAnySize) {
  Graph graph(makeRegistry());
  const std::int64_t large = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t id : {std::int64_t{0}, std::int64_t{1} << 40, large}) graph.addVertex<VertexSE2>(id);
  graph.addEdge<EdgeSE2>({large, 0}, unit, weight3());
  EXPECT_EQ(graph.findVertex(large)->id(), large);
  graph.removeVertex(large);
  EXPECT_EQ(graph.findVertex(large), nullptr);
  EXPECT_EQ(graph.edgeCount(), 0);
}

TEST(Graph, RefusesBadEdges) {
  Graph graph = chain();
  graph.addVertex<VertexPoint>(9);
  const auto add = [&](std::initializer_list<std::int64_t> ids) { graph.addEdge<EdgeSE2>(ids, unit, weight3()); };
  EXPECT_THAT([&] { add({0, 5}); }, ThrowsMessage<GraphError>(HasSubstr("vertex 5, which does not exist")));
  EXPECT_THAT([&] { add({0, 0}); }, ThrowsMessage<GraphError>(HasSubstr("0")));
  EXPECT_THAT([&] { add({0, 9}); }, ThrowsMessage<GraphError>(HasSubstr("VERTEX_POINT")));
  EXPECT_THAT([&] { add({0, 1, 2}); }, ThrowsMessage<GraphError>(HasSubstr("joins 2 vertices, not 3")));
  EXPECT_THROW(graph.addEdge<EdgeShifted>({9}, Vector<double, 2>(0.0, 0.0), weight2()), GraphError);
  EXPECT_THROW(graph.addEdge<EdgeShifted>({9}, Vector<double, 2>(0.0, 0.0), weight2(), {3}), GraphError);
  EXPECT_EQ(graph.edgeCount(), 2);
}

TEST(Graph, RefusesWhatIsNoInformationMatrix) {
  Graph graph = chain();
  const auto add = [&](const Matrix<double, 3, 3>& information) { graph.addEdge<EdgeSE2>({0, 2}, unit, information); };
  Matrix<double, 3, 3> bad = weight3();
  bad(0, 1) = 0.5;
  EXPECT_THROW(add(bad), GraphError);
  bad(1, 0) = 0.5;
  EXPECT_NO_THROW(add(bad));
  bad(0, 1) = bad(1, 0) = 2.0;
  EXPECT_THROW(add(bad), GraphError);
  bad(0, 1) = bad(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(add(bad), GraphError);
  EXPECT_NO_THROW(add(weight3(0.0)));
  EXPECT_EQ(graph.edgeCount(), 4);
}

TEST(Graph, RefusesTypesThatAreNotRegistered) {
  Graph graph(std::make_shared<Registry>());
  EXPECT_THAT([&] { graph.addVertex<VertexSE2>(0); }, ThrowsMessage<GraphError>(HasSubstr("registry->addVertex")));
  EXPECT_THROW(Graph(nullptr), GraphError);
}

TEST(Graph, RemovesVerticesWithTheirEdges) {
  Graph graph = chain();
  graph.removeVertex(1);
  EXPECT_EQ(graph.vertexCount(), 2);
  EXPECT_EQ(graph.edgeCount(), 0);
  EXPECT_THROW(graph.removeVertex(1), GraphError);
  Edge& edge = graph.addEdge<EdgeSE2>({0, 2}, unit, weight3());
  edge.setLevel(3);
  graph.removeEdge(edge);
  EXPECT_EQ(graph.edgeCount(), 0);
  const Edge& again = graph.addEdge<EdgeSE2>({2, 0}, unit, weight3());
  EXPECT_EQ(again.level(), 0) << "a slot that is used again starts blank";
  int count = 0;
  graph.forEachEdge([&](const Edge&) { ++count; });
  EXPECT_EQ(count, 1);
}

TEST(Graph, RemovesManyVerticesAtOnceOrNone) {
  Graph graph = chain();
  const std::vector<std::int64_t> wrong{0, 77}, right{2, 0, 2};
  EXPECT_THROW(graph.removeVertices(wrong), GraphError);
  EXPECT_EQ(graph.vertexCount(), 3);
  EXPECT_EQ(graph.edgeCount(), 2);
  graph.removeVertices(right);
  EXPECT_EQ(graph.vertexCount(), 1);
  EXPECT_EQ(graph.edgeCount(), 0);
  EXPECT_NE(graph.findVertex(1), nullptr);
}

TEST(Graph, WhatIsMovedFromIsEmpty) {
  Graph graph = chain(), target = chain();
  target.removeVertex(1);
  target = std::move(graph);
  EXPECT_EQ(target.edgeCount(), 2);
  EXPECT_EQ(graph.vertexCount(), 0);
  EXPECT_EQ(graph.edgeCount(), 0);
  graph.addVertex<VertexSE2>(5);
  EXPECT_EQ(graph.vertexCount(), 1);
}

TEST(Graph, CopiesAreIndependentAndMovesKeepAddresses) {
  Graph graph = chain();
  const Vertex* address = graph.findVertex(1);
  Graph copy(graph);
  copy.vertex<VertexSE2>(1).setEstimate(SE2<double>(50.0, 0.0, 0.0));
  copy.removeVertex(0);
  EXPECT_EQ(graph.vertex<VertexSE2>(1).estimate().x(), 1.0);
  EXPECT_EQ(graph.edgeCount(), 2);
  EXPECT_EQ(copy.edgeCount(), 1);
  const Graph moved(std::move(graph));
  EXPECT_EQ(moved.findVertex(1), address);
  EXPECT_EQ(moved.vertexCount(), 3);
  Graph assigned(makeRegistry());
  assigned = copy;
  EXPECT_EQ(assigned.vertex<VertexSE2>(1).estimate().x(), 50.0);
  EXPECT_EQ(assigned.edgeCount(), 1);
}

TEST(Graph, AddressesStayWhileTheGraphGrowsAndShrinks) {
  constexpr std::int64_t count = 100000;
  Graph graph(makeRegistry());
  std::vector<const Vertex*> addresses;
  for (std::int64_t id = 0; id < count; ++id) addresses.push_back(&graph.addVertex<VertexPoint>(id));
  for (std::int64_t id = 0; id < count; id += 2) graph.removeVertex(id);
  EXPECT_EQ(graph.vertexCount(), count / 2);
  for (std::int64_t id = 1; id < count; id += 2)
    ASSERT_EQ(graph.findVertex(id), addresses[static_cast<std::size_t>(id)]);
  for (std::int64_t id = 0; id < count; id += 2) {
    Vertex& vertex = graph.addVertex<VertexPoint>(id);
    ASSERT_FALSE(vertex.hasEstimate());
    ASSERT_FALSE(vertex.fixed());
  }
  EXPECT_EQ(graph.vertexCount(), count);
}

TEST(Graph, ZeroesOnlyWhatHasMembersOfItsOwn) {
  EXPECT_TRUE(EdgePoint::addsNothing<EdgePoint>());
  EXPECT_TRUE(EdgeSE2::addsNothing<EdgeSE2>());
  EXPECT_FALSE(EdgeShifted::addsNothing<EdgeShifted>());
  EXPECT_FALSE(EdgeSquares::addsNothing<EdgeSquares>()) << "padding behind a run-time dimension may hold a member";
  Graph graph(makeRegistry());
  graph.addVertex<VertexPoint>(0, Vector<double, 2>(1.0, 2.0));
  const std::array<std::int64_t, 1> ids{0};
  const auto& edge = static_cast<const EdgePoint&>(graph.addEdge(*graph.registry()->findEdgeType("EDGE_POINT"), ids));
  EXPECT_EQ(edge.measurement(), (Vector<double, 2>(0.0, 0.0)));
  EXPECT_EQ(edge.information(), (Matrix<double, 2, 2>::Identity()));
  EXPECT_EQ(edge.level(), 0);
  EXPECT_EQ(edge.robustKernel().name(), "none");
}

TEST(Graph, KeepsNumbersToTheLastBit) {
  Graph graph = chain();
  const double angle = std::nextafter(3.0, 4.0);
  graph.vertex<VertexSE2>(0).setEstimate(SE2<double>(0.1, 1.0 / 3.0, angle));
  const SE2<double> estimate = graph.vertex<VertexSE2>(0).estimate();
  EXPECT_EQ(estimate.y(), 1.0 / 3.0);
  EXPECT_EQ(estimate.angle(), angle);
}

}  // namespace
}  // namespace quiver
