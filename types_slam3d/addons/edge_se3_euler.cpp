#include <quiver/types_slam3d/addons/edge_se3_euler.h>

#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>

namespace quiver {
namespace {

using Matrix6 = Matrix<double, 6, 6>;

SE3<double> poseOf(const std::array<double, 27>& line) {
  return SE3<double>(detail::fromEuler(line[3], line[4], line[5]), Vector<double, 3>(line[0], line[1], line[2]));
}

Matrix6 informationOf(const std::array<double, 27>& line) {
  Matrix6 information;
  std::size_t k = 6;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) information(r, c) = information(c, r) = line[k++];
  }
  return information;
}

Matrix6 eulerJacobian(const SE3<double>& pose) {
  Matrix6 J = Matrix6::Identity();
  J.bottomRightCorner<3, 3>() = detail::eulerByQuaternion(pose.rotation());
  return J;
}

/// From Euler angles to the quaternion's vector part; symmetric to the last bit.
Matrix6 mapped(const Matrix6& information, const SE3<double>& pose) {
  const Matrix6 J = eulerJacobian(pose);
  const Matrix6 product = J.transpose() * information * J;
  return 0.5 * (product + product.transpose());
}

}  // namespace

std::vector<Field> EdgeSE3Euler::fields() {
  std::vector<Field> result = VertexSE3Euler::fields();
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) {
      result.push_back(
          {fmt::format("I{}{}", r + 1, c + 1), "", r + c == 0 ? "information in (x, y, z, roll, pitch, yaw)" : ""});
    }
  }
  return result;
}

void EdgeSE3Euler::read(FieldReader& reader) {
  reader.reals(line_);
  const SE3<double> pose = poseOf(line_);
  const Matrix6 information = mapped(informationOf(line_), pose);
  if (!information.allFinite() || !detail::hasQuaternionChart(pose.rotation())) {
    reader.fail("the angles' information cannot be mapped to the quaternion's for half a turn");
  }
  setMeasurement(pose);
  // The reader checks it, and mends it on request.
  std::size_t k = 0;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) informationStore().values()[k++] = information(r, c);
  }
}

void EdgeSE3Euler::write(FieldWriter& writer) const {
  const SE3<double> pose = measurement();
  if (pose.toVector() == poseOf(line_).toVector() && information() == mapped(informationOf(line_), pose)) {
    writer.reals(line_);
    return;
  }
  const SO3<double>& q = pose.rotation();
  const Vector<double, 3> t = pose.translation();
  const Vector<double, 3> angles = detail::toEuler<double>(q.x(), q.y(), q.z(), q.w());
  writer.reals({t.data(), 3});
  writer.reals({angles.data(), 3});
  const Matrix6 inverse = eulerJacobian(pose).inverse();
  const Matrix6 information = inverse.transpose() * this->information() * inverse;
  for (int r = 0; r < 6; ++r) {
    for (int c = r; c < 6; ++c) writer.real(information(r, c));
  }
}

}  // namespace quiver
