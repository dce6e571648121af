// The name of a type is the whole one; two classes of one name are told by their size.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <quiver/core/util/error.h>
#include <quiver/core/util/type_name.h>

#include "core_types.h"

/// Of the same short name as a class of quiver's tests.
class VertexPoint : public quiver::BaseVertex<VertexPoint, 3, quiver::Vector<double, 3>> {
 public:
  static quiver::Vector<double, 3> oplus(const quiver::Vector<double, 3>& x, const quiver::Vector<double, 3>& delta) {
    return x + delta;
  }
};
class VertexSE2 : public quiver::BaseVertex<VertexSE2, 3, quiver::Vector<double, 3>> {
 public:
  static quiver::Vector<double, 3> oplus(const quiver::Vector<double, 3>& x, const quiver::Vector<double, 3>& delta) {
    return x + delta;
  }
};

namespace quiver {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <typename A, typename B>
struct Pair {};

TEST(TypeName, IsWhole) {
  EXPECT_EQ(typeName<double>(), "double");
  EXPECT_EQ(typeName<::VertexSE2>(), "VertexSE2");
  EXPECT_EQ(typeName<quiver::VertexSE2>(), "quiver::VertexSE2");
  EXPECT_NE((typeName<Pair<int[3], float>>()), (typeName<Pair<int[3], double>>()));
  EXPECT_THAT(std::string(typeName<Pair<int[3], float>>()), HasSubstr("float"));
}

TEST(TypeName, AGlobalClassIsNoneOfQuivers) {
  auto registry = test::makeRegistry();
  Graph graph(registry);
  const Vector<double, 3> x(1.0, 2.0, 3.0);
  EXPECT_THAT([&] { graph.addVertex<::VertexSE2>(1, x); }, ThrowsMessage<GraphError>(HasSubstr("is not registered")));
  registry->addVertex<::VertexSE2>("VERTEX_OWN");
  EXPECT_EQ(graph.addVertex<::VertexSE2>(1, x).estimate(), x);
  EXPECT_EQ(graph.typeOf(*graph.findVertex(1)).tag(), "VERTEX_OWN");
  graph.addVertex<quiver::VertexSE2>(2, SE2<double>(1.0, 2.0, 3.0));
  EXPECT_EQ(graph.typeOf(*graph.findVertex(2)).tag(), "VERTEX_SE2");
  EXPECT_THROW((void)graph.vertex<::VertexSE2>(2), GraphError);
}

TEST(MovedGraph, IsEmptyAndUsable) {
  Graph graph(test::makeRegistry());
  graph.addVertex<test::VertexPoint>(1, Vector<double, 2>(1.0, 2.0));
  graph.addEdge<test::EdgePoint>({1}, Vector<double, 2>(0.0, 0.0), test::weight2());
  const Graph moved = std::move(graph);
  EXPECT_EQ(moved.vertexCount(), 1);
  EXPECT_EQ(graph.vertexCount(), 0);
  EXPECT_EQ(graph.edgeCount(), 0);
  EXPECT_EQ(graph.findVertex(1), nullptr);
  graph.addVertex<test::VertexPoint>(1, Vector<double, 2>(1.0, 2.0));
  EXPECT_EQ(graph.vertexCount(), 1);
}

}  // namespace
}  // namespace quiver
