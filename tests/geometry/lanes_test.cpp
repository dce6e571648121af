#include <Eigen/Geometry>

#include "tests/geometry/scalar_support.h"

namespace quiver {
namespace {

template <class Isa>
class LanesTest : public ::testing::Test {
 public:
  using L = Lanes<Isa>;
  void SetUp() override {
    if (!test::runs<Isa>()) GTEST_SKIP() << "the machine lacks the instruction set";
  }
  static L random(std::mt19937_64& generator, double low, double high) {
    std::uniform_real_distribution<double> uniform(low, high);
    double x[8];
    for (double& each : x) each = uniform(generator);
    return L::load(x);
  }
  /// The worst distance in ulps of f from the reference over random arguments in [low, high].
  template <class F, class G>
  static double worst(F f, G reference, double low, double high, int draws = 20000) {
    std::mt19937_64 generator(7);
    double result = 0.0;
    for (int k = 0; k < draws; ++k) {
      const L x = random(generator, low, high);
      const L y = f(x);
      for (int i = 0; i < 8; ++i) result = std::max(result, test::ulpsBetween(y[i], reference(x[i])));
    }
    return result;
  }
};
TYPED_TEST_SUITE(LanesTest, test::AllIsas);

template <class A>
concept ConvertsToBool = requires(A a) {
  a ? 1 : 0;
};
template <class A>
concept StdSqrtTakes = requires(A a) {
  std::sqrt(a);
};

TYPED_TEST(LanesTest, MasksAreNoBools) {
  using L = Lanes<TypeParam>;
  static_assert(!ConvertsToBool<LanesMask<TypeParam>>);
  static_assert(!ConvertsToBool<MaskOf<L>>);
  static_assert(!ConvertsToBool<MaskOf<Dual<L, 2>>>);
  static_assert(ConvertsToBool<MaskOf<double>>);
  static_assert(!StdSqrtTakes<L> && !StdSqrtTakes<Dual<double, 2>> && !StdSqrtTakes<Dual<L, 2>>);
}

TYPED_TEST(LanesTest, ArithmeticIsThatOfDouble) {
  using L = Lanes<TypeParam>;
  std::mt19937_64 generator(1);
  for (int k = 0; k < 100; ++k) {
    const L a = this->random(generator, -3.0, 3.0), b = this->random(generator, -3.0, 3.0);
    const L sum = a + b, difference = a - 2.0, product = 3.0 * a, quotient = a / b, negative = -a;
    const L root = sqrt(abs(a)), low = min(a, b), high = max(a, b), down = floor(a), near = rint(a);
    L updated = a;
    updated += b;
    updated *= 2.0;
    const L fused = fma(a, b, L(1.0));
    for (int i = 0; i < 8; ++i) {
      EXPECT_EQ(sum[i], a[i] + b[i]);
      EXPECT_EQ(difference[i], a[i] - 2.0);
      EXPECT_EQ(product[i], 3.0 * a[i]);
      EXPECT_EQ(quotient[i], a[i] / b[i]);
      EXPECT_EQ(negative[i], -a[i]);
      EXPECT_EQ(root[i], std::sqrt(std::abs(a[i])));
      EXPECT_EQ(low[i], std::min(a[i], b[i]));
      EXPECT_EQ(high[i], std::max(a[i], b[i]));
      EXPECT_EQ(down[i], std::floor(a[i]));
      EXPECT_EQ(near[i], std::rint(a[i]));
      EXPECT_EQ(updated[i], (a[i] + b[i]) * 2.0);
      EXPECT_EQ(fused[i], std::fma(a[i], b[i], 1.0));
    }
  }
}

TYPED_TEST(LanesTest, ComparisonsSelectLaneByLane) {
  using L = Lanes<TypeParam>;
  const double numbers[8] = {-2, -1, -0.0, 0.0, 1, 2, 3, 4};
  const L x = L::load(numbers);
  const L chosen = select(x < 0.0, L(-1.0), x);
  const L sign = signOf(x);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(chosen[i], numbers[i] < 0 ? -1.0 : numbers[i]);
    EXPECT_EQ(sign[i], numbers[i] >= 0 ? 1.0 : -1.0);
    EXPECT_EQ((x >= 1.0)[i], numbers[i] >= 1.0);
    EXPECT_EQ((x != 1.0)[i], numbers[i] != 1.0);
    EXPECT_EQ((x > 0.0 && x < 3.0)[i], numbers[i] > 0 && numbers[i] < 3);
    EXPECT_EQ((!(x > 0.0) || x == 3.0)[i], numbers[i] <= 0 || numbers[i] == 3);
  }
  EXPECT_TRUE(any(x > 3.5));
  EXPECT_FALSE(any(x > 4.5));
  EXPECT_TRUE(all(x > -3.0));
  EXPECT_FALSE(all(x > -2.0));
}

TYPED_TEST(LanesTest, IsFiniteLooksAtEveryLane) {
  using L = Lanes<TypeParam>;
  const double numbers[8] = {1, -1, 0, INFINITY, -INFINITY, NAN, 1e308, 5e-324};
  const auto mask = isfinite(L::load(numbers));
  for (int i = 0; i < 8; ++i) EXPECT_EQ(mask[i], std::isfinite(numbers[i]));
}

// Each bound is in units in the last place against libm, itself within 1.
TYPED_TEST(LanesTest, TrigonometryAgreesWithLibm) {
  const auto sine = [](const auto& x) { return sin(x); };
  const auto cosine = [](const auto& x) { return cos(x); };
  for (const double range : {1e-8, 1e-3, 1.0, 4.0, 100.0, 9e4, 1e7, 1e300}) {
    EXPECT_LE(this->worst(
                  sine, [](double x) { return std::sin(x); }, -range, range),
              2.0)
        << range;
    EXPECT_LE(this->worst(
                  cosine, [](double x) { return std::cos(x); }, -range, range),
              2.0)
        << range;
  }
  EXPECT_LE(this->worst([](const auto& x) { return tan(x); }, [](double x) { return std::tan(x); }, -10, 10), 4.0);
}

TYPED_TEST(LanesTest, MultiplesOfHalfPiAreExactToTheBit) {
  using L = Lanes<TypeParam>;
  for (int n = -60000; n <= 60000; n += 8) {
    double x[8];
    for (int i = 0; i < 8; ++i) x[i] = (n + i) * 1.5707963267948966;
    const auto both = sincos(L::load(x));
    for (int i = 0; i < 8; ++i) {
      EXPECT_LE(test::ulpsBetween(both.sine[i], std::sin(x[i])), 2.0) << x[i];
      EXPECT_LE(test::ulpsBetween(both.cosine[i], std::cos(x[i])), 2.0) << x[i];
    }
  }
}

TYPED_TEST(LanesTest, Atan2AgreesWithLibm) {
  using L = Lanes<TypeParam>;
  std::mt19937_64 generator(3);
  double worst = 0.0;
  for (const double scale : {1e-12, 1e-3, 1.0, 1e6}) {
    for (int k = 0; k < 5000; ++k) {
      const L y = this->random(generator, -scale, scale), x = this->random(generator, -1.0, 1.0);
      const L angle = atan2(y, x);
      for (int i = 0; i < 8; ++i) worst = std::max(worst, test::ulpsBetween(angle[i], std::atan2(y[i], x[i])));
    }
  }
  EXPECT_LE(worst, 2.0);
  for (const double y : {-1.0, -0.0, 0.0, 1.0}) {
    for (const double x : {-1.0, -0.0, 0.0, 1.0}) {
      const double angle = atan2(L(y), L(x))[3];
      EXPECT_LE(test::ulpsBetween(angle, std::atan2(y, x)), 1.0) << y << ' ' << x;
      EXPECT_EQ(std::signbit(angle), std::signbit(y));
    }
  }
}

TYPED_TEST(LanesTest, InverseTrigonometryAgreesWithLibm) {
  EXPECT_LE(this->worst([](const auto& x) { return atan(x); }, [](double x) { return std::atan(x); }, -9, 9), 2.0);
  EXPECT_LE(this->worst([](const auto& x) { return asin(x); }, [](double x) { return std::asin(x); }, -1, 1), 4.0);
  EXPECT_LE(this->worst([](const auto& x) { return acos(x); }, [](double x) { return std::acos(x); }, -1, 1), 4.0);
}

TYPED_TEST(LanesTest, ExpAndLogAgreeWithLibm) {
  const auto exponential = [](const auto& x) { return exp(x); };
  const auto logarithm = [](const auto& x) { return log(x); };
  for (const double range : {1e-10, 1e-2, 1.0, 30.0, 700.0}) {
    EXPECT_LE(this->worst(
                  exponential, [](double x) { return std::exp(x); }, -range, range),
              2.0)
        << range;
  }
  EXPECT_LE(this->worst(
                exponential, [](double x) { return std::exp(x); }, -745.0, -709.0),
            1.0);  // subnormal
  for (const double range : {0.01, 0.9, 2.0, 1e3, 1e300}) {
    EXPECT_LE(this->worst(
                  logarithm, [](double x) { return std::log(x); }, 0.0, range),
              2.0)
        << range;
  }
  EXPECT_LE(this->worst(
                logarithm, [](double x) { return std::log(x); }, 1 - 1e-6, 1 + 1e-6),
            2.0);
  using L = Lanes<TypeParam>;
  EXPECT_EQ(exp(L(800.0))[0], INFINITY);
  EXPECT_EQ(exp(L(-800.0))[0], 0.0);
  EXPECT_EQ(log(L(0.0))[0], -INFINITY);
  EXPECT_TRUE(std::isnan(log(L(-1.0))[0]));
  EXPECT_EQ(log(L(5e-324))[0], std::log(5e-324));
}

TYPED_TEST(LanesTest, ServeAsEigenScalar) {
  using L = Lanes<TypeParam>;
  Eigen::Matrix<L, 3, 3> a = Eigen::Matrix<L, 3, 3>::Constant(L(2.0));
  const Eigen::Matrix<L, 3, 1> b(L(1.0), L(2.0), L(3.0));
  const Eigen::Matrix<L, 3, 1> c = 2.0 * (a * b) + b * 0.5;
  EXPECT_EQ(c[2][5], 25.5);
  EXPECT_EQ(b.norm()[1], std::sqrt(14.0));
  EXPECT_EQ(b.cross(c).dot(b)[0], 0.0);
}

}  // namespace
}  // namespace quiver
