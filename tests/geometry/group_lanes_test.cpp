#include "tests/geometry/group_support.h"

namespace quiver {
namespace {

using test::dimensionOf;
using test::spaceOf;

/// Numbers evaluate() reads (two tangents, a point) and writes.
template <class Group>
inline constexpr int inputsOf = 2 * dimensionOf<Group> + spaceOf<Group>;
template <class Group>
inline constexpr int outputsOf = 4 * dimensionOf<Group> + 2 * spaceOf<Group>;

/// Every operation of a group, as a user's error function would call it.
template <class Group, class S>
void evaluate(const S* in, S* out) {
  using G = typename Group::template Of<S>;
  using P = Packing<typename Group::template Of<double>>;
  constexpr int n = dimensionOf<Group>, d = spaceOf<Group>;
  const Vector<S, n> v = Packing<Vector<double, n>>::load(in), w = Packing<Vector<double, n>>::load(in + n);
  const Vector<S, d> p = Packing<Vector<double, d>>::load(in + 2 * n);
  const G a = G::exp(v), b = G::exp(w);
  const G product = a * b;
  Vector<S, n> results[4] = {product.log(), a.adjoint() * w, w, w};
  // Left out: second derivatives, and what takes the compiler long (7 x 7 matrices inlined into one loop).
  if constexpr (!isDual<S> && n < 7) {
    if constexpr (requires { G::leftJacobian(v); }) results[2] = G::rightJacobian(v) * w;
    if constexpr (requires { G::leftJacobianInverse(v); }) results[3] = G::rightJacobianInverse(v) * w;
  }
  static_assert(P::dimension == n);
  const Vector<S, d> q = product * p, r = a.actInverse(p);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 4; ++k) out[k * n + i] = results[k][i];
  }
  for (int i = 0; i < d; ++i) {
    out[4 * n + i] = q[i];
    out[4 * n + d + i] = r[i];
  }
}

/// Batch loops, one an instruction set. With duals the first tangent's first two coordinates are the variables.
template <class Isa>
struct Batch;
#define QUIVER_TEST_BATCH(isaName, attribute)                                     \
  template <>                                                                     \
  struct Batch<isa::isaName> {                                                    \
    template <class Group>                                                        \
    attribute static void run(const double* in, double* out) {                    \
      using L = Lanes<isa::isaName>;                                              \
      L x[inputsOf<Group>], y[outputsOf<Group>];                                  \
      for (int i = 0; i < inputsOf<Group>; ++i) x[i] = L::load(in + 8 * i);       \
      evaluate<Group>(x, y);                                                      \
      for (int i = 0; i < outputsOf<Group>; ++i) y[i].store(out + 8 * i);         \
    }                                                                             \
    template <class Group>                                                        \
    attribute static void runDuals(const double* in, double* out) {               \
      using L = Lanes<isa::isaName>;                                              \
      using D = Dual<L, 2>;                                                       \
      D x[inputsOf<Group>], y[outputsOf<Group>];                                  \
      for (int i = 0; i < inputsOf<Group>; ++i) x[i] = D(L::load(in + 8 * i), i); \
      evaluate<Group>(x, y);                                                      \
      for (int i = 0; i < outputsOf<Group>; ++i) {                                \
        y[i].value.store(out + 24 * i);                                           \
        y[i].gradient[0].store(out + 24 * i + 8);                                 \
        y[i].gradient[1].store(out + 24 * i + 16);                                \
      }                                                                           \
    }                                                                             \
  };
QUIVER_TEST_BATCH(Generic, )  // called, not flattened: quick to compile
QUIVER_TEST_BATCH(Avx2, QUIVER_BATCH_LOOP_AVX2)
QUIVER_TEST_BATCH(Avx512, QUIVER_BATCH_LOOP_AVX512)
#undef QUIVER_TEST_BATCH

template <class Group>
class GroupLanesTest : public ::testing::Test {
 public:
  static constexpr int n = dimensionOf<Group>, d = spaceOf<Group>;
  // Both sides round differently (fused or not); intermediate numbers are up to 10.
  static constexpr double tolerance = 4e-14;

  std::mt19937_64 generator{9};
  /// Input `i` of lane `lane` at [8 i + lane]; every lane has another angle.
  std::vector<double> inputs(int round) {
    std::vector<double> in(8 * inputsOf<Group>);
    constexpr double angles[16] = {0.0,      1e-12,    1e-8, 1e-4, 9.9e-4, 1.1e-3, 0.01, 0.1,
                                   0.999999, 1.000001, 1.1,  0.9,  1.2,    1.3,    1.4,  1.45};
    for (int lane = 0; lane < 8; ++lane) {
      const auto v = test::randomTangent<Group>(generator, angles[(lane + round) % 16]);
      const auto w = test::randomTangent<Group>(generator, angles[(3 * lane + round) % 16]);
      for (int i = 0; i < n; ++i) {
        in[8 * i + lane] = v[i];
        in[8 * (n + i) + lane] = w[i];
      }
      for (int i = 0; i < d; ++i) in[8 * (2 * n + i) + lane] = 0.5 * i - lane * 0.1;
    }
    return in;
  }

  template <class Isa>
  void compareValues() {
    if (!test::runs<Isa>()) return;
    for (int round = 0; round < 32; ++round) {
      const std::vector<double> in = inputs(round);
      std::vector<double> out(8 * outputsOf<Group>);
      Batch<Isa>::template run<Group>(in.data(), out.data());
      for (int lane = 0; lane < 8; ++lane) {
        double x[inputsOf<Group>], y[outputsOf<Group>];
        for (int i = 0; i < inputsOf<Group>; ++i) x[i] = in[8 * i + lane];
        evaluate<Group>(x, y);
        for (int i = 0; i < outputsOf<Group>; ++i) EXPECT_NEAR(out[8 * i + lane], y[i], tolerance) << i;
      }
    }
  }

  template <class Isa>
  requires(dimensionOf<Group> < 7) void compareDuals() {
    if (!test::runs<Isa>()) return;
    using D = Dual<double, 2>;
    for (int round = 0; round < 32; ++round) {
      const std::vector<double> in = inputs(round);
      std::vector<double> out(24 * outputsOf<Group>);
      Batch<Isa>::template runDuals<Group>(in.data(), out.data());
      for (int lane = 0; lane < 8; ++lane) {
        D x[inputsOf<Group>], y[outputsOf<Group>];
        for (int i = 0; i < inputsOf<Group>; ++i) x[i] = D(in[8 * i + lane], i);
        evaluate<Group>(x, y);
        for (int i = 0; i < outputsOf<Group>; ++i) {
          EXPECT_NEAR(out[24 * i + lane], y[i].value, tolerance) << i;
          EXPECT_NEAR(out[24 * i + 8 + lane], y[i].gradient[0], 2 * tolerance) << i;
          EXPECT_NEAR(out[24 * i + 16 + lane], y[i].gradient[1], 2 * tolerance) << i;
        }
      }
    }
  }
};
using Groups =
    ::testing::Types<test::PlaneRotations, test::PlaneMotions, test::Rotations, test::Motions, test::Similarities>;
TYPED_TEST_SUITE(GroupLanesTest, Groups);

TYPED_TEST(GroupLanesTest, PlainLoopsAgreeWithDouble) { this->template compareValues<isa::Generic>(); }
TYPED_TEST(GroupLanesTest, Avx2AgreesWithDouble) { this->template compareValues<isa::Avx2>(); }
TYPED_TEST(GroupLanesTest, Avx512AgreesWithDouble) { this->template compareValues<isa::Avx512>(); }
TYPED_TEST(GroupLanesTest, DualsOverAvx512AgreeWithDualsOverDouble) {
  if constexpr (TestFixture::n < 7) this->template compareDuals<isa::Avx512>();
}

}  // namespace
}  // namespace quiver
