#include "core_types.h"

#include <gtest/gtest.h>

namespace quiver::test {

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
