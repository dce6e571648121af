#include <quiver/core/graph/bulk_adder.h>

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/parallel.h>

#include "core_types.h"

namespace quiver {
namespace {

using namespace test;
using detail::BulkAdder;
using detail::ElementCounts;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

int typeOfPose(const Registry& registry) { return registry.findVertexType("VERTEX_SE2")->index(); }
int typeOfOdometry(const Registry& registry) { return registry.findEdgeType("EDGE_SE2")->index(); }

/// Parts that have so many poses and edges between poses each.
std::vector<ElementCounts> partsOf(const Registry& registry, std::vector<std::pair<int, int>> counts) {
  std::vector<ElementCounts> parts;
  for (const auto& [poses, edges] : counts) {
    parts.emplace_back(registry);
    parts.back().vertices[static_cast<std::size_t>(typeOfPose(registry))] = poses;
    parts.back().edges[static_cast<std::size_t>(typeOfOdometry(registry))] = edges;
  }
  return parts;
}

TEST(BulkAdder, KeepsTheOrderOfThePartsWhicheverIsFilledFirst) {
  const auto registry = makeRegistry();
  const int pose = typeOfPose(*registry);
  const int odometry = typeOfOdometry(*registry);
  Graph graph(registry);
  graph.addVertex<VertexSE2>(5000, SE2<double>(1, 2, 3));
  {
    constexpr int perPart = 300;
    BulkAdder adder(graph, partsOf(*registry, {{perPart, 0}, {perPart, perPart}, {0, perPart}}));
    for (int id = 0; id < 2 * perPart; ++id) ASSERT_TRUE(adder.nameVertex(pose, id));
    EXPECT_FALSE(adder.nameVertex(pose, 7));
    EXPECT_FALSE(adder.nameVertex(pose, 5000));
    adder.open();
    graph.addVertex<VertexSE2>(6000);
    for (const std::size_t part : {2u, 0u, 1u}) {
      adder.begin(part);
      for (int i = 0; i < perPart; ++i) {
        const std::int64_t id = static_cast<int>(part) * perPart + i;
        if (part < 2) adder.addVertex(part, pose, id);
        if (part > 0) adder.addEdge(part, odometry, std::vector<std::int64_t>{i, id % 600 == i ? i + 1 : id % 600}, {});
      }
    }
    adder.finish();
  }
  EXPECT_EQ(graph.vertexCount(), 602);
  EXPECT_EQ(graph.edgeCount(), 600);
  std::vector<std::int64_t> ids;
  graph.forEachVertex([&](const Vertex& vertex) { ids.push_back(vertex.id()); });
  ASSERT_EQ(ids.size(), 602u);
  EXPECT_EQ(ids.front(), 5000);
  EXPECT_EQ(ids.back(), 6000);
  for (std::int64_t i = 0; i < 600; ++i) {
    EXPECT_EQ(ids[static_cast<std::size_t>(i + 1)], i);
    EXPECT_EQ(graph.findVertex(i)->id(), i);
  }
  std::int64_t count = 0;
  graph.forEachEdge([&](const Edge& edge) { EXPECT_EQ(edge.vertexId(0), count++ % 300); });
  graph.removeVertex(3);
  const Graph copy = graph;
  EXPECT_EQ(copy.vertexCount(), 601);
  EXPECT_EQ(copy.edgeCount(), graph.edgeCount());
}

TEST(BulkAdder, FillsPartsFromSeveralThreads) {
  const auto registry = makeRegistry();
  constexpr std::int64_t parts = 40;
  constexpr std::int64_t perPart = 50;
  Graph graph(registry);
  {
    BulkAdder adder(graph, partsOf(*registry, std::vector<std::pair<int, int>>(parts, {perPart, perPart})));
    for (std::int64_t id = 0; id < parts * perPart; ++id) adder.nameVertex(typeOfPose(*registry), id);
    adder.open();
    parallelFor(parts, 4, [&](std::int64_t part) {
      const auto p = static_cast<std::size_t>(part);
      adder.begin(p);
      for (std::int64_t i = 0; i < perPart; ++i) {
        const std::int64_t id = part * perPart + i;
        adder.addVertex(p, typeOfPose(*registry), id);
        adder.addEdge(p, typeOfOdometry(*registry), std::vector<std::int64_t>{id, (id + 77) % (parts * perPart)}, {});
      }
    });
    adder.finish();
  }
  std::int64_t next = 0;
  graph.forEachVertex([&](const Vertex& vertex) { EXPECT_EQ(vertex.id(), next++); });
  next = 0;
  graph.forEachEdge([&](const Edge& edge) { EXPECT_EQ(edge.vertexId(0), next++); });
  EXPECT_EQ(next, parts * perPart);
}

TEST(BulkAdder, ChecksEdges) {
  const auto registry = makeRegistry();
  Graph graph(registry);
  BulkAdder adder(graph, partsOf(*registry, {{2, 3}}));
  for (int id = 0; id < 2; ++id) adder.nameVertex(typeOfPose(*registry), id);
  adder.open();
  adder.begin(0);
  const auto add = [&](std::vector<std::int64_t> ids) { adder.addEdge(0, typeOfOdometry(*registry), ids, {}); };
  EXPECT_THAT([&] { add({0, 5}); }, ThrowsMessage<GraphError>(HasSubstr("vertex 5, which does not exist")));
  EXPECT_THAT([&] { add({1, 1}); }, ThrowsMessage<GraphError>(HasSubstr("twice")));
  EXPECT_THAT([&] { add({0, 1, 1}); }, ThrowsMessage<GraphError>(HasSubstr("joins 2 vertices, not 3")));
}

TEST(BulkAdder, MayBeLeftAtAnyPoint) {
  const auto registry = makeRegistry();
  for (int stage = 0; stage < 4; ++stage) {
    Graph graph(registry);
    BulkAdder adder(graph, partsOf(*registry, {{300, 300}, {1, 400}}));
    if (stage == 0) continue;
    for (int id = 0; id < 301; ++id) adder.nameVertex(typeOfPose(*registry), id);
    if (stage == 1) continue;
    adder.open();
    if (stage == 2) continue;
    adder.begin(1);
  }
}

/// Its elements cannot be made later, since that may throw.
class VertexWithList : public BaseVertex<VertexWithList, 1, Vector<double, 1>> {
 public:
  VertexWithList() : list_(3, 7) {
    if (refuse) throw std::runtime_error("refused");
  }
  static Vector<double, 1> oplus(const Vector<double, 1>& x, const Vector<double, 1>& delta) { return x + delta; }
  int sum() const { return list_[0] + list_[1] + list_[2]; }
  static inline bool refuse = false;

 private:
  std::vector<int> list_;
};

TEST(BulkAdder, TakesElementsWhoseConstructorMayThrow) {
  const auto registry = makeRegistry();
  const int type = registry->addVertex<VertexWithList>("VERTEX_LIST").index();
  ElementCounts counts(*registry);
  counts.vertices[static_cast<std::size_t>(type)] = 5;
  Graph graph(registry);
  {
    BulkAdder adder(graph, {counts});
    for (int id = 0; id < 5; ++id) adder.nameVertex(type, id);
    adder.open();
    adder.begin(0);
    for (int id = 0; id < 5; ++id) adder.addVertex(0, type, id);
    adder.finish();
  }
  for (int id = 0; id < 5; ++id) EXPECT_EQ(graph.vertex<VertexWithList>(id).sum(), 21);
  Graph other(registry);
  BulkAdder adder(other, {counts});
  VertexWithList::refuse = true;
  EXPECT_THROW(adder.open(), std::runtime_error);
  VertexWithList::refuse = false;
}

}  // namespace
}  // namespace quiver
