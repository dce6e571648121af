#pragma once

#include <span>
#include <vector>

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/point_jacobian.h>
#include <quiver/types_slam2d/vertex_se2.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {

/// Two points seen at once: X⁻¹ l₁ − z₁ above X⁻¹ l₂ − z₂, with one information matrix (g2o's EDGE_SE2_TWOPOINTSXY).
class EdgeSE2TwoXY : public BaseEdge<EdgeSE2TwoXY, 4, Vector<double, 4>, VertexSE2, VertexXY, VertexXY> {
 public:
  template <typename S>
  static Vector<S, 4> computeError(const Vector<S, 4>& z, const SE2<S>& pose, const Vector<S, 2>& first,
                                   const Vector<S, 2>& second) {
    const Vector<S, 2> p = pose.actInverse(first), q = pose.actInverse(second);
    return Vector<S, 4>(p[0] - z[0], p[1] - z[1], q[0] - z[2], q[1] - z[3]);
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 4>&, const SE2<S>& pose, const Vector<S, 2>& first,
                             const Vector<S, 2>& second, Matrix<S, 4, 3>& J0, Matrix<S, 4, 2>& J1,
                             Matrix<S, 4, 2>& J2) {
    detail::seenPointByPose<S>(pose.actInverse(first), J0);
    detail::seenPointByPose<S>(pose.actInverse(second), J0, 2);
    J1.setZero();
    detail::transposedRotation<S>(pose.rotation(), J1);
    J2.setZero();
    detail::transposedRotation<S>(pose.rotation(), J2, 2);
  }

  static bool initialEstimate(int to, const Vector<double, 4>& z, SE2<double>& pose, Vector<double, 2>& first,
                              Vector<double, 2>& second) {
    if (to == 0) return false;
    (to == 1 ? first : second) = pose * Vector<double, 2>(to == 1 ? z.head<2>() : z.tail<2>());
    return true;
  }

  static std::vector<Field> fields() { return {{"x1", "m", ""}, {"y1", "m", ""}, {"x2", "m", ""}, {"y2", "m", ""}}; }
};

/// Any number of points seen at once: X⁻¹ lᵢ − zᵢ stacked, with one information matrix (g2o's EDGE_SE2_LOTSOFXY).
/// The measurement holds x₁ y₁ x₂ y₂ ….
class EdgeSE2ManyXY : public BaseEdge<EdgeSE2ManyXY, Dynamic, std::vector<double>, VertexSE2, AnyNumberOf<VertexXY>> {
 public:
  template <typename S>
  static Vector<S, Dynamic> computeError(const std::vector<double>& z, const SE2<S>& pose,
                                         std::span<const Vector<S, 2>> points) {
    Vector<S, Dynamic> error(2 * static_cast<Eigen::Index>(points.size()));
    Eigen::Index row = 0;
    for (const Vector<S, 2>& point : points) {
      const Vector<S, 2> p = pose.actInverse(point);
      for (int i = 0; i < 2; ++i, ++row) error[row] = p[i] - z[static_cast<std::size_t>(row)];
    }
    return error;
  }

  static void linearizeOplus(const std::vector<double>&, const SE2<double>& pose,
                             std::span<const Vector<double, 2>> points, Matrix<double, Dynamic, 3>& J0,
                             std::span<Matrix<double, Dynamic, 2>> J) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const int row = 2 * static_cast<int>(i);
      detail::seenPointByPose<double>(pose.actInverse(points[i]), J0, row);
      J[i].setZero();
      detail::transposedRotation<double>(pose.rotation(), J[i], row);
    }
  }

  static std::vector<Field> fields() {
    return {{"count", "", "of points, then x y [m] of each in the body"}, {"x1", "m", ""}, {"y1", "m", ""}};
  }
  void read(FieldReader& reader) {
    const std::int64_t count = reader.integer();
    if (count != arity() - 1) reader.fail("the number of points is not that of the vertices");
    std::vector<double> z(static_cast<std::size_t>(2 * count));
    reader.reals(z);
    setMeasurement(z);
    informationStore().resize(static_cast<int>(2 * count));
  }
  void write(FieldWriter& writer) const {
    const std::vector<double> z = measurement();
    writer.integer(static_cast<std::int64_t>(z.size() / 2));
    writer.reals(z);
  }
};

}  // namespace quiver
