#include "tests/geometry/group_support.h"

namespace quiver {
namespace {

using test::dimensionOf;
using test::randomTangent;
using test::TangentOf;

template <class Group>
class GroupTest : public ::testing::Test {
 public:
  static constexpr int n = dimensionOf<Group>;
  static constexpr int d = test::spaceOf<Group>;
  using G = typename Group::template Of<double>;
  using Tangent = TangentOf<Group>;
  using Point = Vector<double, d>;
  using Square = Matrix<double, n, n>;

  std::mt19937_64 generator{5};
  Tangent tangent(double angle) { return randomTangent<Group>(generator, angle); }
  Tangent anyTangent() { return tangent(std::uniform_real_distribution<double>(0.1, 3.0)(generator)); }
  Point point() {
    std::uniform_real_distribution<double> uniform(-2.0, 2.0);
    Point p;
    for (double& each : p) each = uniform(generator);
    return p;
  }
  /// How far apart two elements are, by what they do to points.
  static double distance(const G& a, const G& b) {
    double worst = (a * Point::Zero().eval() - b * Point::Zero().eval()).norm();
    for (int i = 0; i < d; ++i) {
      const Point e = Point::Unit(i);
      worst = std::max(worst, (a * e - b * e).norm());
    }
    return worst;
  }
};
using Groups =
    ::testing::Types<test::PlaneRotations, test::PlaneMotions, test::Rotations, test::Motions, test::Similarities>;
TYPED_TEST_SUITE(GroupTest, Groups);

// Rounding of products of numbers of size about 10.
constexpr double roundingTolerance = 2e-14;

TYPED_TEST(GroupTest, IsAGroupThatActsOnPoints) {
  using G = typename TestFixture::G;
  for (int k = 0; k < 100; ++k) {
    const G a = G::exp(this->anyTangent()), b = G::exp(this->anyTangent()), c = G::exp(this->anyTangent());
    const auto p = this->point();
    EXPECT_LT(this->distance((a * b) * c, a * (b * c)), roundingTolerance);
    EXPECT_LT(this->distance(a * a.inverse(), G()), roundingTolerance);
    EXPECT_LT(this->distance(a.inverse() * a, G()), roundingTolerance);
    EXPECT_LT(this->distance(G() * a, a), roundingTolerance);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), roundingTolerance);
    EXPECT_LT((a.actInverse(p) - a.inverse() * p).norm(), roundingTolerance);
  }
}

TYPED_TEST(GroupTest, LogInvertsExp) {
  using G = typename TestFixture::G;
  for (const double angle : test::angles) {
    for (int k = 0; k < 50; ++k) {
      const auto v = this->tangent(angle);
      EXPECT_LT((G::exp(v).log() - v).norm(), roundingTolerance) << angle;
    }
  }
}

TYPED_TEST(GroupTest, LogIsAccurateAtHalfATurn) {
  using G = typename TestFixture::G;
  for (const double angle : {pi - 1e-6, pi - 1e-9, pi}) {
    for (int k = 0; k < 50; ++k) {
      const auto v = this->tangent(angle);
      const auto w = G::exp(v).log();
      EXPECT_LT(this->distance(G::exp(w), G::exp(v)), roundingTolerance);  // at pi both signs are right
      if (angle < pi - 1e-10) {
        EXPECT_LT((w - v).norm(), roundingTolerance) << angle;
      }
    }
  }
}

TYPED_TEST(GroupTest, SmallTangentsKeepTheirRelativeAccuracy) {
  using G = typename TestFixture::G;
  for (const double scale : {1e-3, 1e-7, 1e-12, 1e-150}) {
    const typename TestFixture::Tangent v = this->tangent(1.0) * scale;
    EXPECT_LT((G::exp(v).log() - v).norm(), (this->n == 7 ? 4e-16 : 0.0) + roundingTolerance * scale) << scale;
  }
}

TYPED_TEST(GroupTest, AdjointMovesTangentsAcross) {
  using G = typename TestFixture::G;
  for (int k = 0; k < 100; ++k) {
    const G x = G::exp(this->anyTangent());
    const typename TestFixture::Tangent d = this->tangent(0.3);
    EXPECT_LT(this->distance(x * G::exp(d), G::exp(typename TestFixture::Tangent(x.adjoint() * d)) * x),
              5 * roundingTolerance);
  }
}

/// d/dd of log(exp(x)^-1 exp(x + d)) at 0 by dual numbers: the right Jacobian.
template <class Group>
Matrix<double, dimensionOf<Group>, dimensionOf<Group>> rightJacobianByDuals(const TangentOf<Group>& x, double sign) {
  constexpr int n = dimensionOf<Group>;
  using D = Dual<double, n>;
  using G = typename Group::template Of<D>;
  Vector<D, n> moved, constant;
  for (int i = 0; i < n; ++i) {
    moved[i] = D(x[i], i);
    constant[i] = D(x[i]);
  }
  const G g = G::exp(constant).inverse(), h = G::exp(moved);
  const Vector<D, n> result = sign > 0 ? (g * h).log() : (h * g).log();
  Matrix<double, n, n> j;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) j(i, k) = result[i].gradient[k];
  }
  return j;
}

TYPED_TEST(GroupTest, JacobiansAgreeWithDualNumbers) {
  using G = typename TestFixture::G;
  if constexpr (requires { G::leftJacobian(this->tangent(1.0)); }) {
    for (const double angle : test::angles) {
      const auto x = this->tangent(angle);
      EXPECT_LT((G::rightJacobian(x) - rightJacobianByDuals<TypeParam>(x, 1.0)).norm(), 1e-13) << angle;
      EXPECT_LT((G::leftJacobian(x) - rightJacobianByDuals<TypeParam>(x, -1.0)).norm(), 1e-13) << angle;
    }
  }
}

TYPED_TEST(GroupTest, JacobiansAgreeWithCentralDifferences) {
  using G = typename TestFixture::G;
  using Tangent = typename TestFixture::Tangent;
  if constexpr (requires { G::leftJacobian(Tangent()); }) {
    constexpr double h = 1e-5;
    for (const double angle : test::angles) {
      const Tangent x = this->tangent(angle);
      const auto j = G::rightJacobian(x);
      const G inverse = G::exp(x).inverse();
      for (int i = 0; i < this->n; ++i) {
        const Tangent step = h * Tangent::Unit(i);
        const Tangent slope =
            ((inverse * G::exp(Tangent(x + step))).log() - (inverse * G::exp(Tangent(x - step))).log()) / (2 * h);
        EXPECT_LT((j.col(i) - slope).norm(), 1e-9) << angle;  // h^2 and rounding / h
      }
    }
  }
}

TYPED_TEST(GroupTest, JacobianInversesInvert) {
  using G = typename TestFixture::G;
  using Square = typename TestFixture::Square;
  if constexpr (requires { G::leftJacobianInverse(this->tangent(1.0)); }) {
    for (const double angle : test::angles) {
      const auto x = this->tangent(angle);
      EXPECT_LT((G::leftJacobian(x) * G::leftJacobianInverse(x) - Square::Identity()).norm(), 1e-13) << angle;
      EXPECT_LT((G::rightJacobian(x) * G::rightJacobianInverse(x) - Square::Identity()).norm(), 1e-13) << angle;
    }
  }
}

TYPED_TEST(GroupTest, RetractionAndLocalCoordinatesAreInverse) {
  using G = typename TestFixture::G;
  if constexpr (requires { G().retract(this->tangent(1.0)); }) {
    for (int k = 0; k < 50; ++k) {
      const G x = G::exp(this->anyTangent());
      const auto d = this->tangent(0.7);
      EXPECT_LT((x.localCoordinates(x.retract(d)) - d).norm(), roundingTolerance);
    }
  }
}

TYPED_TEST(GroupTest, PackingKeepsEveryBit) {
  using G = typename TestFixture::G;
  using P = Packing<G>;
  static_assert(Packable<G> && alignof(G) <= 8);
  static_assert(P::dimension == TestFixture::n);
  for (int k = 0; k < 20; ++k) {
    const G x = G::exp(this->anyTangent()) * G::exp(this->anyTangent());
    double packed[P::size], again[P::size];
    P::store(x, packed);
    P::store(P::template load<double>(packed), again);
    EXPECT_EQ(std::memcmp(packed, again, sizeof(packed)), 0);
  }
}

}  // namespace
}  // namespace quiver
