#include "core_types.h"

#include <gtest/gtest.h>
#include <quiver/plugins/builtin.h>

namespace quiver::test {

std::shared_ptr<Registry> makeRegistry() {
  auto registry = std::make_shared<Registry>();
  registry->addVertex<VertexSE2>("VERTEX_SE2");
  registry->addVertex<VertexPoint>("VERTEX_POINT");
  registry->addVertex<VertexNumbers>("VERTEX_NUMBERS");
  registry->addParameter<ParameterShift>("PARAMETER_SHIFT");
  registry->addEdge<EdgeSE2>("EDGE_SE2");
  registry->addEdge<EdgeRangeNumeric>("EDGE_RANGE_NUMERIC");
  registry->addEdge<EdgeRangeDual>("EDGE_RANGE_DUAL");
  registry->addEdge<EdgeRangeDualLanes>("EDGE_RANGE_DUAL_LANES");
  registry->addEdge<EdgeRangeAnalytic>("EDGE_RANGE_ANALYTIC");
  registry->addEdge<EdgeRangeAnalyticLanes>("EDGE_RANGE_ANALYTIC_LANES");
  registry->addEdge<EdgePoint>("EDGE_POINT");
  registry->addEdge<EdgeWrong>("EDGE_WRONG");
  registry->addEdge<EdgeShifted>("EDGE_SHIFTED");
  registry->addEdge<EdgeMean>("EDGE_MEAN");
  registry->addEdge<EdgeSquares>("EDGE_SQUARES");
  registerLinearSystems(*registry);
  return registry;
}

TEST(CoreTypes, SayTheirForms) {
  const auto registry = makeRegistry();
  const auto form = [&](const char* tag) { return registry->findEdgeType(tag)->form(); };
  EXPECT_EQ(form("EDGE_RANGE_NUMERIC").jacobians, Jacobians::numeric);
  EXPECT_EQ(form("EDGE_RANGE_DUAL").jacobians, Jacobians::dual);
  EXPECT_FALSE(form("EDGE_RANGE_DUAL").lanes);
  EXPECT_TRUE(form("EDGE_RANGE_DUAL_LANES").lanes);
  EXPECT_EQ(form("EDGE_RANGE_ANALYTIC_LANES").jacobians, Jacobians::analytic);
  EXPECT_TRUE(form("EDGE_RANGE_ANALYTIC_LANES").lanes);
  EXPECT_EQ(form("EDGE_POINT").jacobians, Jacobians::dual);
  EXPECT_EQ(form("EDGE_WRONG").jacobians, Jacobians::analytic);
  EXPECT_EQ(form("EDGE_SHIFTED").jacobians, Jacobians::numeric);
  EXPECT_EQ(form("EDGE_MEAN").jacobians, Jacobians::dual);
  EXPECT_EQ(form("EDGE_SQUARES").jacobians, Jacobians::dual);
}

}  // namespace quiver::test
