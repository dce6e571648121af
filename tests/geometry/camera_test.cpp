#include <quiver/geometry/camera_brown.h>
#include <quiver/geometry/camera_fisheye.h>
#include <quiver/geometry/camera_pinhole.h>
#include <quiver/geometry/camera_snavely.h>

#include "tests/geometry/scalar_support.h"

namespace quiver {
namespace {

/// A plausible calibration of each camera; +1 or -1 for the side it looks to.
template <class Camera>
struct Sample;
template <>
struct Sample<CameraPinhole> {
  static Vector<double, 4> intrinsics() { return {510.0, 490.0, 320.0, 240.0}; }
  static constexpr double forward = 1.0;
};
template <>
struct Sample<CameraBrown> {
  static Vector<double, 9> intrinsics() {
    Vector<double, 9> k;
    k << 510.0, 490.0, 320.0, 240.0, -0.05, 0.02, 1e-3, -2e-3, 0.004;
    return k;
  }
  static constexpr double forward = 1.0;
};
template <>
struct Sample<CameraFisheye> {
  static Vector<double, 8> intrinsics() {
    Vector<double, 8> k;
    k << 310.0, 300.0, 320.0, 240.0, -0.02, 0.005, -1e-3, 1e-4;
    return k;
  }
  static constexpr double forward = 1.0;
};
template <>
struct Sample<CameraSnavely> {
  static Vector<double, 3> intrinsics() { return {800.0, -0.06, 0.02}; }
  static constexpr double forward = -1.0;
};

template <class Camera>
class CameraTest : public ::testing::Test {
 public:
  static constexpr int n = Camera::intrinsicCount;
  std::mt19937_64 generator{3};
  /// A point in view, off the axis by at most about 45 degrees.
  Vector<double, 3> point() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double z = 3.0 + 2.0 * uniform(generator);
    return {0.7 * z * uniform(generator), 0.7 * z * uniform(generator), Sample<Camera>::forward * z};
  }
  /// Compares both analytic Jacobians at p with dual numbers.
  void checkJacobians(const Vector<double, 3>& p) {
    using D = Dual<double, n + 3>;
    const Vector<double, n> k = Sample<Camera>::intrinsics();
    Vector<D, n> intrinsics;
    Vector<D, 3> point;
    for (int i = 0; i < n; ++i) intrinsics[i] = D(k[i], i);
    for (int i = 0; i < 3; ++i) point[i] = D(p[i], n + i);
    const Vector<D, 2> pixel = Camera::project(intrinsics, point);
    const Vector<double, 2> value = Camera::project(k, p);
    const Matrix<double, 2, n> byIntrinsics = Camera::intrinsicsJacobian(k, p);
    const Matrix<double, 2, 3> byPoint = Camera::pointJacobian(k, p);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(pixel[i].value, value[i]);
      // Rounding, relative to a focal length of 500 and distortion terms of that size.
      for (int j = 0; j < n; ++j)
        EXPECT_NEAR(byIntrinsics(i, j), pixel[i].gradient[j], 1e-11) << j << ' ' << p.transpose();
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(byPoint(i, j), pixel[i].gradient[n + j], 1e-11) << j << ' ' << p.transpose();
    }
  }
};
using Cameras = ::testing::Types<CameraPinhole, CameraBrown, CameraFisheye, CameraSnavely>;
TYPED_TEST_SUITE(CameraTest, Cameras);

TYPED_TEST(CameraTest, JacobiansAgreeWithDualNumbers) {
  for (int k = 0; k < 200; ++k) this->checkJacobians(this->point());
}

TYPED_TEST(CameraTest, JacobiansHoldOnAndNearTheAxis) {
  for (const double x : {0.0, 1e-12, 1e-7, 1.9e-6}) this->checkJacobians({x, -x, 2.0 * Sample<TypeParam>::forward});
}

TYPED_TEST(CameraTest, UnprojectInvertsProject) {
  const auto k = Sample<TypeParam>::intrinsics();
  for (int i = 0; i < 200; ++i) {
    const Vector<double, 3> p = this->point();
    const Vector<double, 3> ray = TypeParam::unproject(k, TypeParam::project(k, p));
    EXPECT_LT((ray / ray.norm() - p / p.norm()).norm(), 1e-13);
  }
}

TYPED_TEST(CameraTest, LanesAgreeWithDouble) {
  using L = Lanes<isa::Generic>;
  const auto k = Sample<TypeParam>::intrinsics();
  Vector<L, TestFixture::n> intrinsics;
  for (int i = 0; i < TestFixture::n; ++i) intrinsics[i] = L(k[i]);
  Vector<L, 3> p;
  Vector<double, 3> points[8];
  for (int lane = 0; lane < 8; ++lane) {
    points[lane] = lane == 0 ? Vector<double, 3>(0.0, 0.0, Sample<TypeParam>::forward) : this->point();
    for (int i = 0; i < 3; ++i) p[i][lane] = points[lane][i];
  }
  const Vector<L, 2> pixel = TypeParam::project(intrinsics, p);
  const Matrix<L, 2, 3> jacobian = TypeParam::pointJacobian(intrinsics, p);
  const Vector<L, 3> ray = TypeParam::unproject(intrinsics, pixel);
  for (int lane = 0; lane < 8; ++lane) {
    const Vector<double, 2> expected = TypeParam::project(k, points[lane]);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(pixel[i][lane], expected[i], 1e-12 * 500);
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(jacobian(i, j)[lane], TypeParam::pointJacobian(k, points[lane])(i, j), 1e-12 * 500);
      }
    }
    const Vector<double, 3> direction(ray[0][lane], ray[1][lane], ray[2][lane]);
    EXPECT_LT((direction / direction.norm() - points[lane] / points[lane].norm()).norm(), 1e-13);
  }
}

TEST(CameraFisheyeTest, SeesBeyondARightAngle) {
  const auto k = Sample<CameraFisheye>::intrinsics();
  const Vector<double, 3> p(2.0, 0.0, -0.3);
  const Vector<double, 3> ray = CameraFisheye::unproject(k, CameraFisheye::project(k, p));
  EXPECT_LT((ray - p / p.norm()).norm(), 1e-12);
}

TEST(CameraDepthTest, IsPositiveInFront) {
  EXPECT_TRUE(isDepthPositive(Vector<double, 3>(0, 0, 1)));
  EXPECT_FALSE(isDepthPositive(Vector<double, 3>(0, 0, -1)));
  EXPECT_FALSE(isDepthPositive(Vector<double, 3>(0, 0, 0.1), 0.2));
  EXPECT_TRUE(CameraSnavely::isDepthPositive(Vector<double, 3>(0, 0, -1)));
  EXPECT_FALSE(CameraSnavely::isDepthPositive(Vector<double, 3>(0, 0, 1)));
}

}  // namespace
}  // namespace quiver
