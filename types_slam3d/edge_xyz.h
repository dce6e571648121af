#pragma once

#include <span>
#include <vector>

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/point_jacobian.h>
#include <quiver/types_slam3d/vertex_se3.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

/// The way from one point to another in the world's axes: e = (l₂ − l₁) − z (g2o's EDGE_POINTXYZ).
class EdgeXYZ : public BaseEdge<EdgeXYZ, 3, Vector<double, 3>, VertexXYZ, VertexXYZ> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 3>& z, const Vector<S, 3>& from, const Vector<S, 3>& to) {
    return to - from - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 3>&, const Vector<S, 3>&, const Vector<S, 3>&, Matrix<S, 3, 3>& J0,
                             Matrix<S, 3, 3>& J1) {
    J0 = -Matrix<S, 3, 3>::Identity();
    J1.setIdentity();
  }

  static bool initialEstimate(int to, const Vector<double, 3>& z, Vector<double, 3>& first, Vector<double, 3>& second) {
    if (to == 1) {
      second = first + z;
    } else {
      first = second - z;
    }
    return true;
  }
};

/// A point measured in the world: e = l − z (g2o's EDGE_POINTXYZ_PRIOR).
class EdgePriorXYZ : public BaseEdge<EdgePriorXYZ, 3, Vector<double, 3>, VertexXYZ> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 3>& z, const Vector<S, 3>& point) {
    return point - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 3>&, const Vector<S, 3>&, Matrix<S, 3, 3>& J) {
    J.setIdentity();
  }

  static bool initialEstimate(int, const Vector<double, 3>& z, Vector<double, 3>& point) {
    point = z;
    return true;
  }
};

/// Any number of points seen at once: X⁻¹ lᵢ − zᵢ stacked, with one information matrix (g2o's EDGE_SE3_LOTSOF_XYZ).
/// The measurement holds x₁ y₁ z₁ x₂ ….
class EdgeSE3ManyXYZ
    : public BaseEdge<EdgeSE3ManyXYZ, Dynamic, std::vector<double>, VertexSE3, AnyNumberOf<VertexXYZ>> {
 public:
  template <typename S>
  static Vector<S, Dynamic> computeError(const std::vector<double>& z, const SE3<S>& pose,
                                         std::span<const Vector<S, 3>> points) {
    Vector<S, Dynamic> error(3 * static_cast<Eigen::Index>(points.size()));
    Eigen::Index row = 0;
    for (const Vector<S, 3>& point : points) {
      const Vector<S, 3> p = pose.actInverse(point);
      for (int i = 0; i < 3; ++i, ++row) error[row] = p[i] - z[static_cast<std::size_t>(row)];
    }
    return error;
  }

  static void linearizeOplus(const std::vector<double>&, const SE3<double>& pose,
                             std::span<const Vector<double, 3>> points, Matrix<double, Dynamic, 6>& J0,
                             std::span<Matrix<double, Dynamic, 3>> J) {
    const Matrix<double, 3, 3> toBody = pose.rotation().inverse().matrix();
    const Matrix<double, 3, 3> identity = Matrix<double, 3, 3>::Identity();
    for (std::size_t i = 0; i < points.size(); ++i) {
      Matrix<double, 3, 6> byPose;
      detail::seenPointByPose<double, 3>(identity, pose.actInverse(points[i]), byPose);
      J0.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = byPose;
      J[i].setZero();
      J[i].middleRows<3>(3 * static_cast<Eigen::Index>(i)) = toBody;
    }
  }

  static std::vector<Field> fields() {
    return {{"count", "", "of points, then x y z [m] of each in the body"},
            {"x1", "m", ""},
            {"y1", "m", ""},
            {"z1", "m", ""}};
  }
  void read(FieldReader& reader) {
    const std::int64_t count = reader.integer();
    if (count != arity() - 1) reader.fail("the number of points is not that of the vertices");
    std::vector<double> z(static_cast<std::size_t>(3 * count));
    reader.reals(z);
    setMeasurement(z);
    informationStore().resize(static_cast<int>(3 * count));
  }
  void write(FieldWriter& writer) const {
    const std::vector<double> z = measurement();
    writer.integer(static_cast<std::int64_t>(z.size() / 3));
    writer.reals(z);
  }
};

}  // namespace quiver
