// Errors of the camera types against the formulas of g2o's inventory, computed with homogeneous matrices.
#include <cmath>

#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include <quiver/types_sba/edge_cam.h>
#include <quiver/types_sba/edge_project_bal.h>
#include <quiver/types_sba/edge_project_cam.h>
#include <quiver/types_sba/edge_project_inverse_depth.h>
#include <quiver/types_sba/expmap/edge_project_xyz2uv.h>
#include <quiver/types_sba/expmap/edge_se3_expmap.h>
#include <quiver/types_sba/expmap/edge_se3_project_xyz.h>
#include <quiver/types_sba/models/edge_project.h>
#include <quiver/types_sba/sim3/edge_sim3.h>

namespace quiver {
namespace {

using Matrix4 = Matrix<double, 4, 4>;
using Vector2 = Vector<double, 2>;
using Vector3 = Vector<double, 3>;
using Vector4 = Vector<double, 4>;
constexpr double exact = 1e-12;  // pixels of some hundreds

SE3<double> pose(double a, double b, double c, double wx, double wy, double wz) {
  return SE3<double>(SO3<double>::exp(Vector3(wx, wy, wz)), Vector3(a, b, c));
}
const SE3<double> here = pose(0.3, -0.2, 0.5, 0.1, -0.3, 0.2);
const SE3<double> there = pose(-0.4, 0.1, 0.2, -0.2, 0.1, 0.4);
const Vector3 point(0.7, -0.4, 4.0);

/// T_cw X, in homogeneous coordinates.
Vector3 inCamera(const SE3<double>& cameraToWorld, const Vector3& x) {
  const Vector4 p = cameraToWorld.matrix().inverse() * Vector4(x[0], x[1], x[2], 1.0);
  return p.head<3>();
}

/// (translation part, rotation vector) of the logarithm of a motion's matrix, and the logarithm of its scale.
Vector<double, 7> logarithm(const Matrix4& motion) {
  const Matrix4 log = motion.log();
  Vector<double, 7> v;
  v << log(0, 3), log(1, 3), log(2, 3), log(2, 1), log(0, 2), log(1, 0), log(0, 0);
  return v;
}

TEST(CamEdges, ProjectWithTheMatrixOfTheCamera) {
  Vector<double, 5> k;
  k << 510.0, 480.0, 320.0, 240.0, 0.12;
  const PosedCamera<double> camera(here, k);
  const Vector3 p = inCamera(here, point);
  Matrix<double, 3, 3> K;
  K << k[0], 0.0, k[2], 0.0, k[1], k[3], 0.0, 0.0, 1.0;
  const Vector3 left = K * p, right = K * (p - Vector3(k[4], 0.0, 0.0));
  const Vector3 z(300.0, 200.0, 290.0);
  const Vector3 expected = Vector3(left[0] / left[2], left[1] / left[2], right[0] / right[2]) - z;
  EXPECT_LT((EdgeProjectP2SC::computeError<double>(z, point, camera) - expected).norm(), exact);
  EXPECT_LT((EdgeProjectP2MC::computeError<double>(z.head<2>(), point, camera) - expected.head<2>()).norm(), exact);
  const PosedCamera<double> other(here, Vector<double, 5>::Constant(7.0));
  EXPECT_LT((EdgeProjectP2MCIntrinsics::computeError<double>(z.head<2>(), point, other, k) - expected.head<2>()).norm(),
            exact);

  Vector3 guess;
  PosedCamera<double> known = camera;
  ASSERT_TRUE(EdgeProjectP2SC::initialEstimate(0, expected + z, guess, known));
  EXPECT_LT((guess - point).norm(), 1e-12);
}

TEST(CamEdges, DistanceOfTwoCameras) {
  const PosedCamera<double> a(here, Vector<double, 5>::Ones()), b(there, Vector<double, 5>::Ones());
  const double distance = (here.matrix() - there.matrix()).col(3).norm();
  EXPECT_NEAR(EdgeScale::computeError<double>(1.5, a, b)[0], 1.5 - distance, exact);
  Matrix<double, 1, 6> J0, J1;
  EdgeScale::linearizeOplus<double>(1.5, a, a, J0, J1);
  EXPECT_EQ(J0.norm() + J1.norm(), 0.0);
}

TEST(ExpmapEdges, PoseErrorIsThatOfTheInverses) {
  const SE3<double> z = pose(0.1, 0.4, -0.2, 0.3, 0.2, -0.1);
  // g2o: ln(T2⁻¹ C T1) with T the inverse of the pose in the file and C that of the measurement there.
  const Matrix4 T1 = here.matrix().inverse(), T2 = there.matrix().inverse(), C = z.matrix().inverse();
  const Vector<double, 7> log = logarithm(T2.inverse() * C * T1);
  const Vector<double, 6> e = EdgeSE3Expmap::computeError<double>(z, here, there);
  EXPECT_LT((e.head<3>() - log.segment<3>(3)).norm(), 1e-13);
  EXPECT_LT((e.tail<3>() - log.head<3>()).norm(), 1e-13);
  EXPECT_LT(EdgeSE3Expmap::computeError<double>(here.between(there), here, there).norm(), 1e-14);
}

TEST(ExpmapEdges, ProjectionsSubtractFromTheMeasurement) {
  const double f = 400.0, cx = 320.0, cy = 240.0, baseline = 0.2;
  const Vector3 p = inCamera(here, point), z(330.0, 210.0, 300.0);
  const Vector3 seen(f * p[0] / p[2] + cx, f * p[1] / p[2] + cy, f * (p[0] - baseline) / p[2] + cx);
  const Vector4 k(f, cx, cy, baseline);
  EXPECT_LT((EdgeProjectXYZ2UV::computeError<double>(z.head<2>(), k, point, here) - (z - seen).head<2>()).norm(),
            exact);
  EXPECT_LT((EdgeProjectXYZ2UVU::computeError<double>(z, k, point, here) - (z - seen)).norm(), exact);

  Vector<double, 6> mono;
  mono << z[0], z[1], f, f, cx, cy;
  EXPECT_LT((EdgeSE3ProjectXYZ::computeError<double>(mono, point, here) - (z - seen).head<2>()).norm(), exact);
  Vector<double, 8> stereo;
  stereo << z, f, f, cx, cy, f * baseline;
  EXPECT_LT((EdgeStereoSE3ProjectXYZ::computeError<double>(stereo, point, here) - (z - seen)).norm(), exact);
  Vector<double, 9> monoPose;
  monoPose << mono, point;
  EXPECT_LT((EdgeSE3ProjectXYZOnlyPose::computeError<double>(monoPose, here) - (z - seen).head<2>()).norm(), exact);
  Vector<double, 11> stereoPose;
  stereoPose << stereo, point;
  EXPECT_LT((EdgeStereoSE3ProjectXYZOnlyPose::computeError<double>(stereoPose, here) - (z - seen)).norm(), exact);
}

TEST(InverseDepth, ProjectsThroughTheAnchor) {
  const Vector4 k(400.0, 320.0, 240.0, 0.0);
  const Vector3 psi(0.1, -0.2, 0.25);
  const Vector4 local(psi[0] / psi[2], psi[1] / psi[2], 1.0 / psi[2], 1.0);
  const Vector4 p = here.matrix().inverse() * there.matrix() * local;
  const Vector2 z(310.0, 250.0), seen(400.0 * p[0] / p[2] + 320.0, 400.0 * p[1] / p[2] + 240.0);
  EXPECT_LT((EdgeProjectPSI2UV::computeError<double>(z, k, psi, here, there) - (z - seen)).norm(), exact);
  EXPECT_LT((EdgeProjectInverseDepth::computeError<double>(z, k, psi, there, there) -
             EdgeProjectInverseDepthAnchor::computeError<double>(z, k, psi))
                .norm(),
            exact);
  // A point at infinity has a pixel, too.
  EXPECT_TRUE(EdgeProjectPSI2UV::computeError<double>(z, k, Vector3(0.1, -0.2, 0.0), here, there).allFinite());
  EXPECT_FALSE(EdgeProjectPSI2UV::isDepthPositive(z, k, Vector3(0.1, -0.2, -0.25), here, there));
}

Matrix4 matrixOf(const Sim3<double>& s) {
  Matrix4 m = Matrix4::Identity();
  m.topLeftCorner<3, 3>() = s.scale() * s.rotation().matrix();
  m.topRightCorner<3, 1>() = s.translation();
  return m;
}

TEST(Similarities, ErrorsAreThoseOfTheInverses) {
  CameraSimilarity<double> a, b;
  a.similarity = Sim3<double>(here.rotation(), here.translation(), 1.3);
  b.similarity = Sim3<double>(there.rotation(), there.translation(), 0.8);
  const Sim3<double> z(SO3<double>::exp(Vector3(0.2, -0.1, 0.3)), Vector3(0.1, 0.2, -0.3), 0.7);
  const Matrix4 S1 = matrixOf(a.similarity).inverse(), S2 = matrixOf(b.similarity).inverse();
  const Vector<double, 7> log = logarithm(matrixOf(z).inverse() * S1 * S2.inverse());
  const Vector<double, 7> e = EdgeSim3Expmap::computeError<double>(z, a, b);
  EXPECT_LT((e - detail::rotationFirst(log)).norm(), 1e-13);

  for (int i = 0; i < 8; ++i) a.intrinsics[i] = 100.0 + 10.0 * i;
  const Vector2 pixel(110.0, 130.0);
  const Vector4 forward = S1 * Vector4(point[0], point[1], point[2], 1.0);
  const Vector2 first(100.0 * forward[0] / forward[2] + 120.0, 110.0 * forward[1] / forward[2] + 130.0);
  EXPECT_LT((EdgeProjectSim3::computeError<double>(pixel, point, a) - (pixel - first)).norm(), exact);
  const Vector4 back = S1.inverse() * Vector4(point[0], point[1], point[2], 1.0);
  const Vector2 second(140.0 * back[0] / back[2] + 160.0, 150.0 * back[1] / back[2] + 170.0);
  EXPECT_LT((EdgeProjectInverseSim3::computeError<double>(pixel, point, a) - (pixel - second)).norm(), exact);
}

TEST(BalCameras, ProjectAsTheDataSetsSay) {
  VertexCameraBal vertex;
  vertex.setNumbers({0.3, -0.2, 0.1, 0.5, -0.4, -6.0, 700.0, -0.1, 0.03});
  // Rodrigues' formula.
  const Vector3 w(0.3, -0.2, 0.1);
  const double angle = w.norm();
  const Vector3 axis = w / angle, x(1.0, 0.5, -2.0);
  const Vector3 turned =
      x * std::cos(angle) + axis.cross(x) * std::sin(angle) + axis * axis.dot(x) * (1 - std::cos(angle));
  const Vector3 P = turned + Vector3(0.5, -0.4, -6.0);
  const Vector2 p = -P.head<2>() / P[2];
  const double r = 1.0 - 0.1 * p.squaredNorm() + 0.03 * p.squaredNorm() * p.squaredNorm();
  const Vector2 z(12.0, -30.0);
  EXPECT_LT((EdgeProjectBal::computeError<double>(z, vertex.estimate(), x) - (700.0 * r * p - z)).norm(), exact);
  EXPECT_TRUE(EdgeProjectBal::isDepthPositive(z, vertex.estimate(), x));
  EXPECT_FALSE(EdgeProjectBal::isDepthPositive(z, vertex.estimate(), Vector3(0.0, 0.0, 30.0)));
}

TEST(BalCameras, StayOrthogonalOverManySteps) {
  BalCamera<double> camera;
  Vector<double, 9> step;
  step << 0.3, -0.5, 0.2, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0;
  for (int i = 0; i < 10000; ++i) camera = VertexCameraBal::oplus<double>(camera, step);
  EXPECT_LT((camera.rotation.transpose() * camera.rotation - Matrix<double, 3, 3>::Identity()).norm(), 1e-14);
  const Matrix<double, 3, 3> whole = SO3<double>::exp(Vector3(0.3, -0.5, 0.2) * 10000.0).matrix();
  EXPECT_LT((camera.rotation - whole).norm(), 1e-11);
}

TEST(CameraModels, FisheyeSeesBehindPinholeDoesNot) {
  Vector<double, 8> fisheye = detail::usualIntrinsics<CameraFisheye>();
  const Vector3 behind(1.0, 0.0, -0.5);
  const SE3<double> origin;
  EXPECT_TRUE(EdgeProjectFisheye::isDepthPositive(Vector2::Zero(), fisheye, origin, behind));
  EXPECT_FALSE(EdgeProjectPinhole::isDepthPositive(Vector2::Zero(), Vector4::Ones(), origin, behind));
}

}  // namespace
}  // namespace quiver
