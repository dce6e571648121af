#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/addons/vertex_segment2d.h>
#include <quiver/types_slam2d/point_jacobian.h>
#include <quiver/types_slam2d/vertex_se2.h>

namespace quiver {

namespace detail {

/// A segment seen from a pose: its ends, and the line through them with normal n = (d_y, −d_x) / |d|, d = P₂ − P₁.
template <typename S>
struct SeenSegment {
  Vector<S, 2> first, second;
  /// Unit vector from the first end to the second, and the normal.
  Vector<S, 2> along, normal;
  S length;

  SeenSegment(const SE2<S>& pose, const Vector<S, 4>& segment)
      : first(pose.actInverse(Vector<S, 2>(segment[0], segment[1]))),
        second(pose.actInverse(Vector<S, 2>(segment[2], segment[3]))) {
    using std::sqrt;
    const S x = second[0] - first[0], y = second[1] - first[1];
    length = sqrt(x * x + y * y);
    along = Vector<S, 2>(x / length, y / length);
    normal = Vector<S, 2>(along[1], -along[0]);
  }
  S angle() const {
    using std::atan2;
    return atan2(normal[1], normal[0]);
  }
  Vector<S, 2> middle() const { return Vector<S, 2>(0.5 * (first[0] + second[0]), 0.5 * (first[1] + second[1])); }

  /// Rows of the normal's angle: it turns against the pose, and with the ends across the segment.
  void angleRow(const SO2<S>& r, int row, auto& byPose, auto& bySegment) const {
    const Vector<S, 2> n = r * normal;
    byPose(row, 0) = byPose(row, 1) = S(0.0);
    byPose(row, 2) = S(-1.0);
    bySegment(row, 0) = n[0] / length, bySegment(row, 1) = n[1] / length;
    bySegment(row, 2) = -n[0] / length, bySegment(row, 3) = -n[1] / length;
  }
};

}  // namespace detail

/// A segment whose ends are seen from a pose: X⁻¹ P₁ − z₁ above X⁻¹ P₂ − z₂ (g2o's EDGE_SE2_SEGMENT2D).
class EdgeSE2Segment2D : public BaseEdge<EdgeSE2Segment2D, 4, Vector<double, 4>, VertexSE2, VertexSegment2D> {
 public:
  template <typename S>
  static Vector<S, 4> computeError(const Vector<S, 4>& z, const SE2<S>& pose, const Vector<S, 4>& segment) {
    const Vector<S, 2> p = pose.actInverse(Vector<S, 2>(segment[0], segment[1]));
    const Vector<S, 2> q = pose.actInverse(Vector<S, 2>(segment[2], segment[3]));
    return Vector<S, 4>(p[0] - z[0], p[1] - z[1], q[0] - z[2], q[1] - z[3]);
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 4>&, const SE2<S>& pose, const Vector<S, 4>& segment, Matrix<S, 4, 3>& J0,
                             Matrix<S, 4, 4>& J1) {
    J1.setZero();
    for (int end = 0; end < 4; end += 2) {
      detail::seenPointByPose<S>(pose.actInverse(Vector<S, 2>(segment[end], segment[end + 1])), J0, end);
      detail::transposedRotation<S>(pose.rotation(), J1, end, end);
    }
  }

  static bool initialEstimate(int to, const Vector<double, 4>& z, SE2<double>& pose, Vector<double, 4>& segment) {
    if (to != 1) return false;
    segment << pose * Vector<double, 2>(z.head<2>()), pose * Vector<double, 2>(z.tail<2>());
    return true;
  }

  static std::vector<Field> fields() { return VertexSegment2D::fields(); }
};

/// The line through a segment seen from a pose, n(θ)·p = ρ: e = (wrap(angle − θ), distance − ρ) (g2o's
/// EDGE_SE2_SEGMENT2D_LINE).
class EdgeSE2Segment2DLine : public BaseEdge<EdgeSE2Segment2DLine, 2, Vector<double, 2>, VertexSE2, VertexSegment2D> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& pose, const Vector<S, 4>& segment) {
    const detail::SeenSegment<S> seen(pose, segment);
    const Vector<S, 2> m = seen.middle();
    return Vector<S, 2>(wrapAngle(S(seen.angle() - z[0])), m[0] * seen.normal[0] + m[1] * seen.normal[1] - z[1]);
  }

  /// The distance m·n moves by n·∂m + (m·d̂) ∂angle, m the middle of the segment.
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE2<S>& pose, const Vector<S, 4>& segment, Matrix<S, 2, 3>& J0,
                             Matrix<S, 2, 4>& J1) {
    const detail::SeenSegment<S> seen(pose, segment);
    seen.angleRow(pose.rotation(), 0, J0, J1);
    const Vector<S, 2> m = seen.middle(), n = seen.normal;
    const S lever = m[0] * seen.along[0] + m[1] * seen.along[1];
    J0(1, 0) = -n[0], J0(1, 1) = -n[1];
    J0(1, 2) = n[0] * m[1] - n[1] * m[0] - lever;
    const Vector<S, 2> world = pose.rotation() * n;
    for (int c = 0; c < 4; ++c) J1(1, c) = 0.5 * world[c % 2] + lever * J1(0, c);
  }

  static std::vector<Field> fields() {
    return {{"theta", "rad", "direction of the normal"}, {"rho", "m", "distance along the normal"}};
  }
};

/// One end of a segment and the direction of its normal seen from a pose: e = (P_k − (x, y), wrap(angle − θ)) (g2o's
/// EDGE_SE2_SEGMENT2D_POINTLINE). The measurement is (k, x, y, θ), k = 0 or 1.
class EdgeSE2Segment2DPointLine
    : public BaseEdge<EdgeSE2Segment2DPointLine, 3, Vector<double, 4>, VertexSE2, VertexSegment2D> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 4>& z, const SE2<S>& pose, const Vector<S, 4>& segment) {
    const detail::SeenSegment<S> seen(pose, segment);
    const auto second = z[0] > S(0.5);
    return Vector<S, 3>(select(second, seen.second[0], seen.first[0]) - z[1],
                        select(second, seen.second[1], seen.first[1]) - z[2], wrapAngle(S(seen.angle() - z[3])));
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 4>& z, const SE2<S>& pose, const Vector<S, 4>& segment,
                             Matrix<S, 3, 3>& J0, Matrix<S, 3, 4>& J1) {
    const detail::SeenSegment<S> seen(pose, segment);
    const S second = select(z[0] > S(0.5), S(1.0), S(0.0)), first = 1.0 - second;
    const Vector<S, 2> p(first * seen.first[0] + second * seen.second[0],
                         first * seen.first[1] + second * seen.second[1]);
    detail::seenPointByPose<S>(p, J0);
    Matrix<S, 2, 2> turn;
    detail::transposedRotation<S>(pose.rotation(), turn);
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) {
        J1(r, c) = first * turn(r, c);
        J1(r, c + 2) = second * turn(r, c);
      }
    }
    seen.angleRow(pose.rotation(), 2, J0, J1);
  }

  static std::vector<Field> fields() {
    return {{"end", "", "0 or 1: which end is seen"},
            {"x", "m", ""},
            {"y", "m", ""},
            {"theta", "rad", "direction of the normal"}};
  }
  void read(FieldReader& reader) {
    const std::int64_t end = reader.integer();
    if (end != 0 && end != 1) reader.fail("a segment has the ends 0 and 1");
    Vector<double, 4> z;
    z[0] = static_cast<double>(end);
    reader.reals({z.data() + 1, 3});
    setMeasurement(z);
  }
  void write(FieldWriter& writer) const {
    const Vector<double, 4> z = measurement();
    writer.integer(static_cast<std::int64_t>(z[0]));
    writer.reals({z.data() + 1, 3});
  }
};

}  // namespace quiver
