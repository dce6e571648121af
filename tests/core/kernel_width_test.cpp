// Widths with which kernels cannot compute.
#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/util/error.h>

namespace quiver {
namespace {

TEST(KernelWidth, IsRefusedWhereItsSquareIsOutOfRange) {
  for (const double width : {1e-170, 1e-160, 1e160, 1e300}) {
    EXPECT_THROW(RobustKernel(huberKernel(), width), GraphError) << width;
    EXPECT_THROW(RobustKernel(cauchyKernel(), width), GraphError) << width;
  }
  for (const double width : {1e-100, 1.0, 1e100}) EXPECT_NO_THROW(RobustKernel(huberKernel(), width)) << width;
}

TEST(KernelWidth, LeavesKernelsFiniteWhereItIsTaken) {
  for (const RobustKernelType* type :
       {&huberKernel(), &cauchyKernel(), &tukeyKernel(), &pseudoHuberKernel(), &gemanMcClureKernel(), &welschKernel(),
        &fairKernel(), &saturatedKernel(), &dcsKernel(), &arctanKernel()}) {
    for (const double width : {1e-100, 1e-3, 1.0, 1e100}) {
      for (const double squaredError : {0.0, 1e-3, 1.0, 1e6}) {
        const RobustKernel kernel(*type, width);
        const auto value = type->evaluate(squaredError, kernel.width(), 0.0);
        EXPECT_TRUE(std::isfinite(value.rho)) << type->name << " " << width << " " << squaredError;
        EXPECT_TRUE(std::isfinite(value.weight)) << type->name << " " << width << " " << squaredError;
      }
    }
  }
}

}  // namespace
}  // namespace quiver
