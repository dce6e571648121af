#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include <quiver/core/registry/field_tokens.h>
#include <quiver/core/registry/registry.h>
#include <quiver/core/util/error.h>
#include <quiver/types_slam3d/addons/edge_line3d.h>
#include <quiver/types_slam3d/addons/edge_plane.h>
#include <quiver/types_slam3d/addons/edge_se3_euler.h>
#include <quiver/types_slam3d/edge_se3_prior.h>
#include <quiver/types_slam3d/edge_se3_projection.h>

namespace quiver {
namespace {

using Vector3 = Vector<double, 3>;
constexpr double exact = 1e-14;  // a handful of roundings of numbers around 1

SE3<double> somePose() {
  Vector<double, 6> tangent;
  tangent << 0.3, -1.2, 2.0, 0.4, -0.9, 0.7;
  return SE3<double>::exp(tangent);
}

/// The rotation about an axis by Rodrigues' formula's definition: columns of the matrix.
Matrix<double, 3, 3> about(int axis, double angle) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Matrix<double, 3, 3> R = Matrix<double, 3, 3>::Identity();
  R(i, i) = R(j, j) = std::cos(angle);
  R(j, i) = std::sin(angle);
  R(i, j) = -std::sin(angle);
  return R;
}

TEST(Euler, YawTimesPitchTimesRoll) {
  const double roll = 0.3, pitch = -0.8, yaw = 2.4;
  const SO3<double> rotation = detail::fromEuler(roll, pitch, yaw);
  EXPECT_LT((rotation.matrix() - about(2, yaw) * about(1, pitch) * about(0, roll)).norm(), exact);
  const Vector3 angles = detail::toEuler<double>(rotation.x(), rotation.y(), rotation.z(), rotation.w());
  EXPECT_LT((angles - Vector3(roll, pitch, yaw)).norm(), exact);
}

TEST(Euler, JacobianAgreesWithDifferences) {
  const SO3<double> q = detail::fromEuler(0.5, 0.4, -1.1);
  const Matrix<double, 3, 3> J = detail::eulerByQuaternion(q);
  constexpr double h = 1e-6;
  for (int c = 0; c < 3; ++c) {
    const auto euler = [&](double step) {
      Vector3 v(q.x(), q.y(), q.z());
      v[c] += step;
      return detail::toEuler<double>(v[0], v[1], v[2], std::sqrt(1.0 - v.squaredNorm()));
    };
    EXPECT_LT((J.col(c) - (euler(h) - euler(-h)) / (2.0 * h)).norm(), 1e-8);
  }
}

TEST(Euler, InformationIsMappedAndWrittenBack) {
  detail::TokenWriter line;
  for (const double value : {1.0, 2.0, 3.0, 0.2, -0.3, 0.9}) line.real(value);
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) line.real(r == c ? 10.0 + r : 0.125 * (r - c));
  }
  EdgeSE3Euler edge;
  detail::TokenReader reader(line.tokens());
  edge.read(reader);
  const Matrix<double, 3, 3> J = detail::eulerByQuaternion(edge.measurement().rotation());
  Matrix<double, 3, 3> lower;
  lower << 13.0, -0.125, -0.25, -0.125, 14.0, -0.125, -0.25, -0.125, 15.0;
  EXPECT_LT((edge.information().bottomRightCorner<3, 3>() - J.transpose() * lower * J).norm(), 1e-12);
  EXPECT_EQ(edge.information()(0, 0), 10.0);

  // Changed and changed back: the file's numbers are no longer there to be copied, so the inverse map is used.
  EdgeSE3Euler other;
  other.setMeasurement(edge.measurement());
  other.setInformation(edge.information());
  detail::TokenWriter again;
  other.write(again);
  ASSERT_EQ(again.tokens().size(), line.tokens().size());
  for (std::size_t i = 0; i < again.tokens().size(); ++i) {
    EXPECT_NEAR(again.tokens()[i].real, line.tokens()[i].real, 1e-12) << i;
  }
}

TEST(Euler, PitchOfAQuarterTurnStaysFinite) {
  detail::TokenWriter line;
  for (const double value : {0.0, 0.0, 0.0, 0.0, std::acos(0.0), 0.0}) line.real(value);
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) line.real(r == c ? 1.0 : 0.0);
  }
  EdgeSE3Euler edge;
  detail::TokenReader reader(line.tokens());
  edge.read(reader);
  EXPECT_TRUE(edge.information().allFinite());
}

/// Whether a type takes a line of that many of the numbers.
template <typename Element>
bool takes(const std::vector<double>& numbers, std::size_t count) {
  detail::TokenWriter line;
  for (std::size_t i = 0; i < count; ++i) line.real(numbers[i]);
  detail::TokenReader reader(line.tokens());
  Element element;
  try {
    element.read(reader);
  } catch (const ParseError&) {
    return false;
  }
  return reader.atEnd();
}

TEST(OptionalFields, AreThereWholeOrNotAtAll) {
  const std::vector<double> plane{0.0, 0.0, 1.0, 2.0, 0.5, 0.6, 0.7};
  for (std::size_t count = 0; count <= plane.size(); ++count)
    EXPECT_EQ(takes<VertexPlane>(plane, count), count == 4 || count == 7) << count;
  const std::vector<double> camera{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 500.0, 400.0, 320.0, 240.0, 0.1};
  for (std::size_t count = 0; count <= camera.size(); ++count) {
    EXPECT_EQ(takes<ParameterCamera>(camera, count), count == 7 || count == 11) << count;
    EXPECT_EQ(takes<ParameterStereoCamera>(camera, count), count == 7 || count >= 11) << count;
  }
}

TEST(Priors, HonourTheSensorsPose) {
  const SE3<double> x = somePose();
  const SE3<double> offset(1.0, 0.5, -0.25, 0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5));
  SE3<double> guess;
  ASSERT_TRUE(EdgeSE3Prior::initialEstimate(0, x * offset, offset, guess));
  EXPECT_LT((guess.toVector() - x.toVector()).norm(), exact);
  EXPECT_LT(EdgeSE3XYZPrior::computeError<double>(Vector3((x * offset).translation()), offset, x).norm(), exact);
}

TEST(Cameras, PixelDepthAndDisparity) {
  Vector<double, 11> camera;
  camera << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 500.0, 400.0, 320.0, 240.0;
  const SE3<double> pose = somePose();
  const Vector3 point = pose * Vector3(0.5, -0.25, 2.0);
  EXPECT_LT(EdgeSE3Depth::computeError<double>(Vector3(445.0, 190.0, 2.0), camera, pose, point).norm(), 1e-11);
  const Vector3 z(445.0, 190.0, 0.5);
  EXPECT_LT(EdgeSE3Disparity::computeError<double>(z, camera, pose, point).norm(), 1e-11);
  SE3<double> known = pose;
  Vector3 guess;
  ASSERT_TRUE(EdgeSE3Disparity::initialEstimate(1, z, camera, known, guess));
  EXPECT_LT((guess - point).norm(), 1e-13);
}

TEST(Planes, SeenFromASensor) {
  // The floor z = 1, seen from the origin: its normal is up, at distance 1.
  Vector<double, 4> floor(0.0, 0.0, 1.0, -1.0);
  const SE3<double> lifted(0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 1.0);
  Vector<double, 7> z;
  z << 0.0, 0.0, 1.0, -0.75, 0.0, 0.0, 0.0;
  EXPECT_LT(EdgeSE3Plane::computeError<double>(z, lifted, floor, SE3<double>()).norm(), exact);
  SE3<double> pose = somePose(), sensor = somePose().inverse() * lifted;
  Vector<double, 4> guess;
  ASSERT_TRUE(EdgeSE3Plane::initialEstimate(1, z, pose, guess, sensor));
  EXPECT_LT((guess - floor).norm(), exact);
}

TEST(Lines, StepsKeepThemLines) {
  Vector<double, 6> line;
  const Vector3 d = Vector3(1.0, 2.0, -0.5).normalized();
  line << cross<double>(Vector3(0.3, -1.0, 2.0), d), d;
  const Vector<double, 6> moved = VertexLine3D::oplus<double>(line, Vector<double, 4>(0.2, -0.4, 0.3, 0.1));
  EXPECT_NEAR(moved.tail<3>().norm(), 1.0, exact);
  EXPECT_NEAR(moved.head<3>().dot(moved.tail<3>()), 0.0, exact);
  EXPECT_NEAR(std::atan(moved.head<3>().norm()), std::atan(line.head<3>().norm()) + 0.1, exact);
  // A line through the origin can be moved, too.
  line << 0.0, 0.0, 0.0, d;
  EXPECT_LT((VertexLine3D::oplus<double>(line, Vector<double, 4>::Zero()) - line).norm(), exact);
  EXPECT_NEAR(VertexLine3D::oplus<double>(line, Vector<double, 4>(0.0, 0.0, 0.0, 0.1)).head<3>().norm(), std::tan(0.1),
              exact);
}

TEST(Lines, SeenBySensorAtItsOffset) {
  const SE3<double> offset = somePose().inverse();
  SE3<double> pose = somePose() * SE3<double>(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
  Vector<double, 6> z, line;
  const Vector3 d = Vector3(1.0, 2.0, -0.5).normalized(), p(0.3, -1.0, 2.0);
  z << cross<double>(p, d), d;
  ASSERT_TRUE(EdgeSE3Line3D::initialEstimate(1, z, offset, pose, line));
  const Vector3 direction = line.tail<3>();
  // The line in the world passes through the point where the sensor sees p.
  EXPECT_LT((cross<double>((pose * offset) * p, direction) - line.head<3>()).norm(), exact);
  EXPECT_LT(EdgeSE3Line3D::computeError<double>(z, offset, pose, line).norm(), exact);
}

}  // namespace
}  // namespace quiver
