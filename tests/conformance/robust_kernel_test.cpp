#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <quiver/core/graph/robust_kernels.h>
#include <quiver/core/registry/registry.h>

namespace quiver {
namespace {

/// Squared errors from far inside to far outside the width 1.3, none of them at a kink.
constexpr double samples[] = {1e-6, 1e-3, 0.11, 0.7, 1.21, 2.9, 10.0, 321.0, 1e5};
constexpr double width = 1.3;

double differenceOf(const RobustKernel& kernel, double e, double RobustValue::*member) {
  const double h = 1e-4 * e;
  const auto slope = [&](double step) {
    return (kernel.evaluate(e + step).*member - kernel.evaluate(e - step).*member) / (2.0 * step);
  };
  return (4.0 * slope(0.5 * h) - slope(h)) / 3.0;
}

void expectConsistent(const RobustKernel& kernel) {
  const RobustValue origin = kernel.evaluate(0.0);
  EXPECT_EQ(origin.rho, 0.0) << kernel.name();
  EXPECT_EQ(origin.weight, 1.0) << kernel.name();
  EXPECT_TRUE(std::isfinite(origin.second)) << kernel.name();
  for (const double e : samples) {
    const RobustValue value = kernel.evaluate(e);
    // Differences lose 1e-16 / 1e-4 of the function's size over the step.
    const double lost = 4e-12;
    EXPECT_NEAR(value.weight, differenceOf(kernel, e, &RobustValue::rho), 1e-9 + lost * std::abs(value.rho) / e)
        << kernel.name() << " at " << e;
    EXPECT_NEAR(value.second, differenceOf(kernel, e, &RobustValue::weight),
                1e-9 * std::abs(value.second) + lost * value.weight / e)
        << kernel.name() << " at " << e;
    EXPECT_GE(value.weight, 0.0) << kernel.name();
    EXPECT_GE(value.rho, 0.0) << kernel.name();
  }
}

TEST(RobustKernel, DerivativesOfEveryRegisteredKernel) {
  Registry registry;
  registerRobustKernels(registry);
  ASSERT_EQ(registry.robustKernels().size(), 11u);
  for (const RobustKernelType* type : registry.robustKernels()) expectConsistent(RobustKernel(*type, width));
}

TEST(RobustKernel, ManyAtOnceAreTheSameBits) {
  Registry registry;
  registerRobustKernels(registry);
  std::vector<double> errors{0.0};
  for (const double e : samples) errors.insert(errors.end(), {e, e * width, width});
  for (const RobustKernelType* type : registry.robustKernels()) {
    ASSERT_NE(type->evaluateAll, nullptr) << type->name;
    for (const double w : {width, 1e-3, 1e100}) {
      const RobustKernel kernel(*type, w);
      std::vector<double> rho(errors.size()), weight(errors.size()), second(errors.size());
      kernel.evaluate(errors, {rho.data(), weight.data(), second.data()});
      for (std::size_t i = 0; i < errors.size(); ++i) {
        const RobustValue value = kernel.evaluate(errors[i]);
        EXPECT_EQ(rho[i], value.rho) << type->name << " at " << errors[i];
        EXPECT_EQ(weight[i], value.weight) << type->name << " at " << errors[i];
        EXPECT_TRUE(second[i] == value.second || (std::isnan(second[i]) && std::isnan(value.second)))
            << type->name << " at " << errors[i];
      }
    }
  }
}

TEST(RobustKernel, DerivativesOfBarronForManyShapes) {
  for (const double shape : {-100.0, -2.0, -0.5, -1e-7, 0.0, 1e-13, 1e-7, 0.5, 1.0, 1.999999, 2.0}) {
    expectConsistent(RobustKernelBarron(width, shape));
  }
}

TEST(RobustKernel, ContinuousAtTheirKinks) {
  for (const RobustKernel& kernel :
       {RobustKernel(RobustKernelHuber(width)), RobustKernel(RobustKernelTukey(width)),
        RobustKernel(RobustKernelSaturated(width)), RobustKernel(RobustKernelDCS(width))}) {
    for (const double kink : {width, width * width}) {
      const double below = kernel.evaluate(kink * (1.0 - 1e-12)).rho;
      EXPECT_NEAR(below, kernel.evaluate(kink * (1.0 + 1e-12)).rho, 1e-11) << kernel.name();
    }
  }
}

TEST(RobustKernel, BarronContainsTheOthers) {
  const double root2 = std::sqrt(2.0);
  for (const double e : samples) {
    const double scale = 1e-12 * (1.0 + e);
    EXPECT_NEAR(RobustKernelBarron(width, 2.0).evaluate(e).rho, e, scale);
    EXPECT_NEAR(RobustKernelBarron(width, 1.0).evaluate(e).rho, RobustKernelPseudoHuber(width).evaluate(e).rho, scale);
    EXPECT_NEAR(RobustKernelBarron(width, 0.0).evaluate(e).rho, RobustKernelCauchy(root2 * width).evaluate(e).rho,
                scale);
    EXPECT_NEAR(RobustKernelBarron(width, -2.0).evaluate(e).rho,
                RobustKernelGemanMcClure(4.0 * width * width).evaluate(e).rho, scale);
    // The limit is reached like 1 / shape.
    EXPECT_NEAR(RobustKernelBarron(width, -1e9).evaluate(e).rho, RobustKernelWelsch(root2 * width).evaluate(e).rho,
                1e-7);
  }
}

TEST(RobustKernel, DynamicCovarianceScalingWeighsAsThePaper) {
  const RobustKernelDCS kernel(2.0);
  EXPECT_EQ(kernel.evaluate(1.0).rho, 1.0);
  const double scale = 2.0 * 2.0 / (2.0 + 6.0);
  EXPECT_DOUBLE_EQ(kernel.evaluate(6.0).weight, scale * scale);
  EXPECT_DOUBLE_EQ(kernel.evaluate(6.0).rho, 2.0 * (18.0 - 2.0) / 8.0);
}

TEST(RobustKernel, FoundByNameInAnyCase) {
  Registry registry;
  registerRobustKernels(registry);
  ASSERT_NE(registry.findRobustKernel("gemanmcclure"), nullptr);
  EXPECT_TRUE(registry.findRobustKernel("barron")->hasShape);
  EXPECT_EQ(registry.findRobustKernel("Hubert"), nullptr);
}

}  // namespace
}  // namespace quiver
