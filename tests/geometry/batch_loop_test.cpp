#include "tests/geometry/scalar_support.h"

namespace quiver {
namespace {

/// What a batch loop's relaxed arithmetic must not break: the functions' special cases.
template <class S>
void evaluate(const S& x, const S& y, S* out) {
  const SinCos<S> both = sincos(x);
  out[0] = both.sine;
  out[1] = both.cosine;
  out[2] = atan2(y, x);
  out[3] = exp(y);
  out[4] = log(abs(x));
  out[5] = select(isfinite(x), S(1.0), S(0.0));
  out[6] = select(x < y, x * y, x - y);
  out[7] = asin(y * 0.01) + acos(y * 0.01) + tan(y);
  out[8] = floor(y) + rint(x) + min(x, y) - max(x, y);
  out[9] = S(0.0) * x + pow(abs(x), 1.5);
}
constexpr int outputs = 10;

#define QUIVER_TEST_BATCH(name, isaName, attribute)                    \
  attribute void name(const double* x, const double* y, double* out) { \
    using L = Lanes<isa::isaName>;                                     \
    L result[outputs];                                                 \
    evaluate(L::load(x), L::load(y), result);                          \
    for (int i = 0; i < outputs; ++i) result[i].store(out + 8 * i);    \
  }
QUIVER_TEST_BATCH(runGeneric, Generic, QUIVER_BATCH_LOOP_GENERIC)
QUIVER_TEST_BATCH(runAvx2, Avx2, QUIVER_BATCH_LOOP_AVX2)
QUIVER_TEST_BATCH(runAvx512, Avx512, QUIVER_BATCH_LOOP_AVX512)
#undef QUIVER_TEST_BATCH

void check(void (*batch)(const double*, const double*, double*)) {
  const double xs[8] = {0.0, -0.5, 1e-9, 3.141592653589793, -2e5, 1e7, 1e-310, 12.5};
  const double ys[8] = {0.0, -0.5, 2.0, -1e-17, 3.5, -40.0, 0.3, 2.5};
  double out[8 * outputs];
  batch(xs, ys, out);
  for (int i = 0; i < 8; ++i) {
    const double x = xs[i], y = ys[i];
    const double expected[outputs] = {std::sin(x),
                                      std::cos(x),
                                      std::atan2(y, x),
                                      std::exp(y),
                                      std::log(std::abs(x)),
                                      1.0,
                                      x < y ? x * y : x - y,
                                      std::asin(y * 0.01) + std::acos(y * 0.01) + std::tan(y),
                                      std::floor(y) + std::rint(x) + std::min(x, y) - std::max(x, y),
                                      std::pow(std::abs(x), 1.5)};
    for (int k = 0; k < outputs; ++k) {
      if (std::isinf(expected[k])) {
        EXPECT_EQ(out[8 * k + i], expected[k]) << k;
      } else {
        EXPECT_NEAR(out[8 * k + i], expected[k], 1e-15 * (1.0 + std::abs(expected[k]))) << k << ' ' << x << ' ' << y;
      }
    }
  }
  const double bad[8] = {INFINITY, -INFINITY, NAN, -NAN, 1.0, 1e308, 5e-324, 0.0};
  batch(bad, ys, out);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(out[40 + i], i < 4 ? 0.0 : 1.0) << bad[i];
}

TEST(BatchLoopTest, PlainLoopsKeepSpecialCases) { check(runGeneric); }

TEST(BatchLoopTest, Avx2KeepsSpecialCases) {
  if (!test::runs<isa::Avx2>()) GTEST_SKIP() << "the machine lacks the instruction set";
  check(runAvx2);
}

TEST(BatchLoopTest, Avx512KeepsSpecialCases) {
  if (!test::runs<isa::Avx512>()) GTEST_SKIP() << "the machine lacks the instruction set";
  check(runAvx512);
}

/// Users write plain templates in translation units compiled for the baseline; zeros fold and duals nest.
template <class S>
S userError(const S& a, const S& b) {
  using std::sqrt;
  const Eigen::Matrix<S, 2, 1> v(a * b, a - 2.0 * b);
  return sqrt(v.squaredNorm()) + 0.5;
}
QUIVER_BATCH_LOOP_AVX512 void differentiate(const double* a, const double* b, double* out) {
  using D = Dual<Lanes<isa::Avx512>, 2>;
  const D error = userError(D(Lanes<isa::Avx512>::load(a), 0), D(Lanes<isa::Avx512>::load(b), 1));
  error.value.store(out);
  error.gradient[0].store(out + 8);
  error.gradient[1].store(out + 16);
}

TEST(BatchLoopTest, UserCodeIsDifferentiatedInLanes) {
  if (!test::runs<isa::Avx512>()) GTEST_SKIP() << "the machine lacks the instruction set";
  const double a[8] = {1, 2, 3, 4, 5, 6, 7, 8}, b[8] = {-1, 0.5, 2, -3, 0.1, 9, 1, 1};
  double out[24];
  differentiate(a, b, out);
  using D = Dual<double, 2>;
  for (int i = 0; i < 8; ++i) {
    const D expected = userError(D(a[i], 0), D(b[i], 1));
    EXPECT_NEAR(out[i], expected.value, 1e-14);
    EXPECT_NEAR(out[8 + i], expected.gradient[0], 1e-14);
    EXPECT_NEAR(out[16 + i], expected.gradient[1], 1e-14);
  }
}

}  // namespace
}  // namespace quiver
