#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/types_slam3d/addons/euler_angles.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// A pose in space that stands in files as x y z roll pitch yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (g2o's VERTEX3);
/// otherwise as VertexSE3. Angles that were read are written again as they were while the estimate is unchanged.
class VertexSE3Euler : public BaseVertex<VertexSE3Euler, 6, SE3<double>> {
 public:
  static constexpr std::array tangent = VertexSE3::tangent;

  template <typename S>
  static SE3<S> oplus(const SE3<S>& x, const Vector<S, 6>& delta) {
    return x.retract(delta);
  }
  static Matrix<double, 6, gaugeDirections> gaugeGenerators(const SE3<double>& x) {
    return VertexSE3::gaugeGenerators(x);
  }

  static std::vector<Field> fields() {
    return {{"x", "m", ""},       {"y", "m", ""},    {"z", "m", ""}, {"roll", "rad", "R = Rz(yaw) Ry(pitch) Rx(roll)"},
            {"pitch", "rad", ""}, {"yaw", "rad", ""}};
  }
  void read(FieldReader& reader) {
    Vector<double, 3> t;
    reader.reals({t.data(), 3});
    reader.reals(angles_);
    setEstimate(SE3<double>(detail::fromEuler(angles_[0], angles_[1], angles_[2]), t));
  }
  void write(FieldWriter& writer) const {
    const SO3<double> rotation = estimate().rotation();
    writer.reals({values(), 3});
    if (rotation.coefficients() == detail::fromEuler(angles_[0], angles_[1], angles_[2]).coefficients()) {
      writer.reals(angles_);
    } else {
      const Vector<double, 3> angles = detail::toEuler<double>(rotation.x(), rotation.y(), rotation.z(), rotation.w());
      writer.reals({angles.data(), 3});
    }
  }

 private:
  /// Roll, pitch, yaw as read last.
  std::array<double, 3> angles_{};
};

}  // namespace quiver
