#include "tests/geometry/scalar_support.h"

namespace quiver {
namespace {

constexpr int functions = 31;

/// Every function of the scalar at two arguments, x in (0.1, 0.9), y in (-2, 2).
template <class S>
Eigen::Matrix<S, functions, 1> everyFunction(const S& x, const S& y) {
  using std::abs, std::acos, std::asin, std::atan, std::atan2, std::cos, std::exp, std::log, std::pow, std::sin,
      std::sqrt, std::tan, std::min, std::max, std::hypot, std::cbrt, std::sinh, std::cosh, std::tanh, std::expm1,
      std::log1p, std::log2, std::log10, std::erf;
  Eigen::Matrix<S, functions, 1> f;
  f << x + y, x - 2.0 * y, x * y, y / x, 3.0 / x, 1.0 - x / 2.0, sqrt(x), abs(y), sin(y), cos(y), tan(x), atan2(y, x),
      atan(y), asin(x), acos(x), exp(y), log(x) * pow(x, 2.5), min(x, y) + max(S(x * 2.0), y) + select(y < x, y * y, x),
      hypot(x, y), cbrt(x), sinh(y), cosh(y), tanh(y), expm1(y), log1p(x), log2(x), log10(x), erf(y), hypot(x, 3.0),
      hypot(2.0, y), pow(2.5, y);
  return f;
}

TEST(DualTest, DerivativesAgreeWithCentralDifferences) {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const double x = 0.1 + 0.8 * uniform(generator), y = -2.0 + 4.0 * uniform(generator);
    const auto f = everyFunction(Dual<double, 2>(x, 0), Dual<double, 2>(y, 1));
    const auto value = everyFunction(x, y);
    const double h = 1e-6;
    const Eigen::Matrix<double, functions, 1> alongX = (everyFunction(x + h, y) - everyFunction(x - h, y)) / (2 * h);
    const Eigen::Matrix<double, functions, 1> alongY = (everyFunction(x, y + h) - everyFunction(x, y - h)) / (2 * h);
    for (int i = 0; i < functions; ++i) {
      EXPECT_EQ(f[i].value, value[i]) << i;
      const double tolerance = 1e-6 * (1.0 + std::abs(f[i].gradient[0]) + std::abs(f[i].gradient[1]));  // h^2 f'''
      if (i == 7 && std::abs(y) < 2 * h) continue;  // the kink of |y|
      if (i == 17 && (std::abs(x - y) < 2 * h || std::abs(2 * x - y) < 2 * h)) continue;
      EXPECT_NEAR(f[i].gradient[0], alongX[i], tolerance) << i;
      EXPECT_NEAR(f[i].gradient[1], alongY[i], tolerance) << i;
    }
  }
}

template <class Isa>
class DualOverLanesTest : public ::testing::Test {
  void SetUp() override {
    if (!test::runs<Isa>()) GTEST_SKIP() << "the machine lacks the instruction set";
  }
};
TYPED_TEST_SUITE(DualOverLanesTest, test::AllIsas);

TYPED_TEST(DualOverLanesTest, AgreeWithDualsOverDouble) {
  using L = Lanes<TypeParam>;
  const double xs[8] = {0.11, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.89}, ys[8] = {-2, -1.5, -0.2, 0.3, 0.45, 0.8, 1.3, 2};
  const auto f = everyFunction(Dual<L, 2>(L::load(xs), 0), Dual<L, 2>(L::load(ys), 1));
  for (int lane = 0; lane < 8; ++lane) {
    const auto g = everyFunction(Dual<double, 2>(xs[lane], 0), Dual<double, 2>(ys[lane], 1));
    for (int i = 0; i < functions; ++i) {
      EXPECT_NEAR(f[i].value[lane], g[i].value, 1e-15 * (1 + std::abs(g[i].value)) * 4);
      for (int d = 0; d < 2; ++d) {
        EXPECT_NEAR(f[i].gradient[d][lane], g[i].gradient[d], 4e-15 * (1 + std::abs(g[i].gradient[d])));
      }
    }
  }
}

TEST(DualTest, PowersAreRightWhereLogarithmsAreNot) {
  using D = Dual<double, 2>;
  const D zero(0.0, 0), negative(-2.0, 0);
  EXPECT_EQ(pow(zero, 1.0).gradient[0], 1.0);
  EXPECT_EQ(pow(zero, D(1.0)).gradient[0], 1.0);
  EXPECT_EQ(pow(zero, 2.0).gradient[0], 0.0);
  EXPECT_EQ(pow(zero, 0.5).gradient[0], 0.0);
  EXPECT_EQ(pow(negative, D(2.0)).value, 4.0);
  EXPECT_EQ(pow(negative, D(2.0)).gradient[0], -4.0);
  EXPECT_EQ(pow(negative, D(3.0)).gradient[0], 12.0);
  EXPECT_EQ(pow(negative, D(3.0, 1)).gradient[1], 0.0);
  EXPECT_NEAR(pow(D(2.0, 0), D(3.0, 1)).gradient[1], 8.0 * std::log(2.0), 1e-14);
  EXPECT_NEAR(pow(D(2.0, 0), D(3.0, 1)).gradient[0], 12.0, 1e-14);
}

TEST(DualTest, DegeneratePointsHaveFiniteGradients) {
  using D = Dual<double, 2>;
  const D zeroX(0.0, 0), zeroY(0.0, 1), oneX(1.0, 0);
  const Eigen::Matrix<D, 2, 1> zero(zeroX, zeroY);
  for (const D& f : {sqrt(zeroX), atan2(zeroY, zeroX), asin(oneX), acos(oneX), zero.norm(), pow(zeroX, 2.0),
                     cbrt(zeroX), hypot(zeroX, zeroY)}) {
    EXPECT_TRUE(isfinite(f));
    EXPECT_EQ(f.gradient[0], 0.0);
  }
}

TEST(DualTest, MixesWithConstantsInEigen) {
  using D = Dual<double, 3>;
  Eigen::Matrix<D, 3, 1> x;
  for (int i = 0; i < 3; ++i) x[i] = D(i + 1.0, i);
  Eigen::Matrix3d a;
  a << 1, 2, 3, 4, 5, 6, 7, 8, 10;
  const Eigen::Matrix<D, 3, 1> y = a * x * 2.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_EQ(y[i].gradient[j], 2.0 * a(i, j));
  }
}

}  // namespace
}  // namespace quiver
