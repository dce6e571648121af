#include <tests/io/graph_types.h>

#include <gtest/gtest.h>

namespace quiver::test {

TEST(GraphTypes, AreFoundByTheirTags) {
  const auto registry = makeRegistry();
  EXPECT_EQ(registry->findVertexType("VERTEX_POINT"), registry->findVertexType("VERTEX_XY"));
  EXPECT_TRUE(registry->findEdgeType("EDGE_SE2_LOTSOFXY")->variableArity());
}

}  // namespace quiver::test
