#include "projections.h"

#include <random>

#include <gtest/gtest.h>
#include <quiver/core/algorithm/check_jacobians.h>
#include <quiver/plugins/builtin.h>

namespace quiver::test {

TEST(Bundle, HasRightJacobians) {
  Graph graph = bundle({});
  const JacobianReport report = checkJacobians(graph);
  EXPECT_LT(report.worstDeviation(), 1e-6) << report.describe();
}

}  // namespace quiver::test
