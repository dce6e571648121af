#include <Eigen/LU>
#include <string>

#include "tests/geometry/group_support.h"

namespace quiver {
namespace {

TEST(WrapAngleTest, KeepsAnglesInsideBitByBit) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> uniform(-pi, pi);
  for (int k = 0; k < 1000; ++k) {
    const double a = uniform(generator);
    EXPECT_EQ(wrapAngle(a), a);
    EXPECT_EQ(wrapAngle(Lanes<isa::Generic>(a))[3], a);
  }
  EXPECT_EQ(wrapAngle(pi), pi);
  EXPECT_EQ(wrapAngle(-pi), -pi);
}

TEST(WrapAngleTest, BringsOthersInside) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> uniform(-50.0, 50.0);
  for (int k = 0; k < 1000; ++k) {
    const double a = uniform(generator), w = wrapAngle(a);
    EXPECT_LE(std::abs(w), pi);
    EXPECT_NEAR(std::sin(w), std::sin(a), 1e-14);
    EXPECT_NEAR(std::cos(w), std::cos(a), 1e-14);
    EXPECT_NEAR(wrapAngle(Lanes<isa::Generic>(a))[0], w, 1e-15);
  }
  EXPECT_LE(std::abs(wrapAngle(std::nextafter(pi, 4.0))), pi);
  EXPECT_LE(std::abs(wrapAngle(std::nextafter(3 * pi, 99.0))), pi);
}

TEST(SE2Test, KeepsTheAngleItWasGiven) {
  for (const double angle : {0.1, -3.141592653589793, 3.2, -7.0, 1e-300}) {
    EXPECT_EQ(SE2<double>(1.0, 2.0, angle).toVector()[2], angle);
    EXPECT_EQ(SE2<double>(1.0, 2.0, angle).angle(), angle);
  }
}

TEST(SE2Test, RetractionMovesInTheBodyFrame) {
  const SE2<double> pose(1.0, 2.0, pi / 2);
  const SE2<double> moved = pose.retract(Vector<double, 3>(1.0, 0.0, pi));
  EXPECT_NEAR(moved.x(), 1.0, 1e-15);
  EXPECT_NEAR(moved.y(), 3.0, 1e-15);
  EXPECT_NEAR(moved.angle(), -pi / 2, 1e-15);
}

TEST(SE2Test, LongChainsStayOnTheUnitCircle) {
  SE2<double> pose;
  const SE2<double> step(0.1, 0.0, 0.01);
  for (int k = 0; k < 100000; ++k) pose = pose * step;
  const auto& r = pose.rotation();
  EXPECT_NEAR(r.cosine() * r.cosine() + r.sine() * r.sine(), 1.0, 1e-15);
  EXPECT_NEAR(std::remainder(std::atan2(r.sine(), r.cosine()) - r.angle(), 2 * pi), 0.0, 1e-10);
}

TEST(SO3Test, KeepsUnitQuaternionsBitByBit) {
  const double q[4] = {-0.1, 0.7, -0.1, -0.7};  // squares sum to 1
  const SO3<double> r(q[0], q[1], q[2], q[3]);
  EXPECT_EQ(r.x(), q[0]);
  EXPECT_EQ(r.y(), q[1]);
  EXPECT_EQ(r.z(), q[2]);
  EXPECT_EQ(r.w(), q[3]);
}

TEST(SO3Test, NormalisesOtherQuaternions) {
  const SO3<double> r(-1.0, 2.0, 3.0, -4.0);
  EXPECT_NEAR(r.coefficients().squaredNorm(), 1.0, 1e-15);
  EXPECT_NEAR(r.w(), -4.0 / std::sqrt(30.0), 1e-15);
  const SO3<double> close(1e-6, 0.0, 0.0, 1.0);  // 1e-12 off
  EXPECT_LT(close.w(), 1.0);
}

TEST(SO3Test, MatricesAndQuaternionsConvert) {
  std::mt19937_64 generator(4);
  for (const double angle : test::angles) {
    for (int k = 0; k < 50; ++k) {
      const SO3<double> r = SO3<double>::exp(test::randomTangent<test::Rotations>(generator, angle));
      const Matrix<double, 3, 3> m = r.matrix();
      EXPECT_LT((m * m.transpose() - Matrix<double, 3, 3>::Identity()).norm(), 1e-14);
      EXPECT_NEAR(m.determinant(), 1.0, 1e-14);
      EXPECT_LT((SO3<double>::fromMatrix(m).matrix() - m).norm(), 1e-14);
      const Vector<double, 3> p(1.0, -2.0, 0.5);
      EXPECT_LT((r * p - m * p).norm(), 1e-14);
      EXPECT_LT((r.actInverse(p) - m.transpose() * p).norm(), 1e-14);
      EXPECT_LT((vee<double>(hat<double>(p)) - p).norm(), 1e-300);
    }
  }
}

TEST(SO3Test, LogTakesTheShortWayForEitherSign) {
  const SO3<double> r = SO3<double>::exp(Vector<double, 3>(0.3, 0.2, -0.1));
  const SO3<double> same = SO3<double>::fromUnit(-r.x(), -r.y(), -r.z(), -r.w());
  EXPECT_LT((same.log() - r.log()).norm(), 1e-15);
}

TEST(SE3Test, ApproximateJacobianInverseIsOfSecondOrder) {
  std::mt19937_64 generator(4);
  const Vector<double, 6> v = test::randomTangent<test::Motions>(generator, 1.0);
  for (const double scale : {1e-2, 1e-3}) {
    const Vector<double, 6> x = scale * v;
    const Matrix<double, 6, 6> error =
        SE3<double>::rightJacobianInverseApproximation(x) - SE3<double>::rightJacobianInverse(x);
    EXPECT_LT(error.norm(), scale * scale);
  }
}

TEST(SE3Test, RetractionKeepsQuaternionsOfUnitLength) {
  SE3<double> pose;
  std::mt19937_64 generator(4);
  for (int k = 0; k < 100000; ++k) pose = pose.retract(test::randomTangent<test::Motions>(generator, 0.3));
  EXPECT_NEAR(pose.rotation().coefficients().norm(), 1.0, 1e-15);
}

// The translation is the integral of exp(u sigma) Exp(u phi) rho over u in [0, 1]; here by Gauss' rule in panels.
TEST(Sim3Test, TranslationAgreesWithQuadrature) {
  constexpr double nodes[5] = {-0.906179845938664, -0.5384693101056831, 0.0, 0.5384693101056831, 0.906179845938664};
  constexpr double weights[5] = {0.23692688505618908, 0.47862867049936647, 0.5688888888888889, 0.47862867049936647,
                                 0.23692688505618908};
  constexpr int panels = 100;
  std::mt19937_64 generator(6);
  for (const double sigma : {0.0, 1e-9, -1e-4, 0.5, -3.0, 12.0, -12.0}) {
    for (const double angle : test::angles) {
      Vector<double, 7> v = test::randomTangent<test::Similarities>(generator, angle);
      v[6] = sigma;
      Vector<double, 3> integral = Vector<double, 3>::Zero();
      for (int k = 0; k < 5 * panels; ++k) {
        const double u = (k / 5 + 0.5 + 0.5 * nodes[k % 5]) / panels;
        const SO3<double> turn = SO3<double>::exp(Vector<double, 3>(u * v.segment<3>(3)));
        integral += 0.5 * weights[k % 5] / panels * std::exp(u * sigma) * (turn * Vector<double, 3>(v.head<3>()));
      }
      const Sim3<double> x = Sim3<double>::exp(v);
      // At sigma = -12 the sum loses what its largest term, exp(12/16), and four doublings cost: a few digits of 1e-16.
      EXPECT_LT((x.translation() - integral).norm(), 1e-13 * (1.0 + integral.norm())) << sigma << ' ' << angle;
      EXPECT_LT((x.log() - v).norm(), 1e-12) << sigma << ' ' << angle;
    }
  }
}

TEST(PackingTest, EigenTypesKeepEveryBit) {
  const Matrix<double, 2, 3> m = Matrix<double, 2, 3>::Random();
  double packed[6];
  Packing<Matrix<double, 2, 3>>::store(m, packed);
  EXPECT_EQ((Packing<Matrix<double, 2, 3>>::load(packed)), m);
  static_assert(Packable<double> && Packable<Vector<double, 3>> && !Packable<int> && !Packable<std::string>);
  static_assert(!Packable<Vector<double, Dynamic>>);
  static_assert(std::is_same_v<Rebound<SE3<double>, Lanes<isa::Avx2>>, SE3<Lanes<isa::Avx2>>>);
}

}  // namespace
}  // namespace quiver
