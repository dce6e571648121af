#include <quiver/core/util/chi_squared.h>

#include <cmath>

#include <gtest/gtest.h>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

/// P(χ² ≤ value) by Simpson's rule over t = √x, where the density 2 t^(k−1) e^(−t²/2) / (2^(k/2) Γ(k/2)) is smooth.
double integrated(double value, int dimension) {
  constexpr int intervals = 20000;
  const double end = std::sqrt(value);
  const double h = end / intervals;
  const double scale = 2.0 / (std::pow(2.0, 0.5 * dimension) * std::tgamma(0.5 * dimension));
  const auto density = [&](double t) { return scale * std::pow(t, dimension - 1) * std::exp(-0.5 * t * t); };
  double sum = density(0.0) + density(end);
  for (int i = 1; i < intervals; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * density(i * h);
  return sum * h / 3.0;
}

TEST(ChiSquared, TailIsTheDensitysIntegral) {
  for (const int dimension : {1, 2, 3, 4, 6, 7, 12, 40}) {
    for (const double share : {0.05, 0.5, 0.9, 1.0, 1.1, 2.0, 4.0}) {
      const double value = share * dimension;
      EXPECT_NEAR(chiSquaredTail(value, dimension), 1.0 - integrated(value, dimension), 1e-12)
          << value << " of " << dimension;
    }
  }
}

TEST(ChiSquared, TailOfTwoDimensionsIsExponentialHoweverFarOut) {
  for (const double value : {1e-9, 0.1, 3.0, 50.0, 600.0, 1400.0})
    EXPECT_NEAR(chiSquaredTail(value, 2) / std::exp(-0.5 * value), 1.0, 1e-12) << value;
  EXPECT_EQ(chiSquaredTail(0.0, 3), 1.0);
  EXPECT_EQ(chiSquaredTail(INFINITY, 3), 0.0);
}

TEST(ChiSquared, QuantilesOfTheTables) {
  EXPECT_NEAR(chiSquaredQuantile(0.95, 1), 3.841458820694124, 1e-12);
  EXPECT_NEAR(chiSquaredQuantile(0.95, 3), 7.814727903251179, 1e-12);
  EXPECT_NEAR(chiSquaredQuantile(0.95, 6), 12.591587243743977, 1e-12);
  EXPECT_NEAR(chiSquaredQuantile(0.5, 2), 2.0 * std::log(2.0), 1e-12);
}

TEST(ChiSquared, QuantileInvertsTheTail) {
  for (const int dimension : {1, 3, 6, 50}) {
    for (const double probability : {1e-6, 0.01, 0.3, 0.7, 0.99, 1.0 - 1e-9}) {
      const double value = chiSquaredQuantile(probability, dimension);
      EXPECT_NEAR(chiSquaredTail(value, dimension), 1.0 - probability, 1e-13) << probability << " of " << dimension;
    }
  }
}

TEST(ChiSquared, RefusesNonsense) {
  EXPECT_THROW((void)chiSquaredTail(1.0, 0), GraphError);
  EXPECT_THROW((void)chiSquaredTail(-1.0, 2), GraphError);
  EXPECT_THROW((void)chiSquaredTail(NAN, 2), GraphError);
  EXPECT_THROW((void)chiSquaredQuantile(0.0, 2), GraphError);
  EXPECT_THROW((void)chiSquaredQuantile(1.0, 2), GraphError);
  EXPECT_THROW((void)chiSquaredQuantile(0.5, -1), GraphError);
}

}  // namespace
}  // namespace quiver
