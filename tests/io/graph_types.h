#pragma once

#include <memory>

#include <quiver/core/graph/graph.h>
#include <quiver/geometry/se2.h>
#include <quiver/geometry/se3.h>

namespace quiver::test {

// Types of every shape that a file can hold, under the tags that files use. Their errors are as plain as can be.

class Pose2 : public BaseVertex<Pose2, 3, SE2<double>> {
 public:
  static SE2<double> oplus(const SE2<double>& x, const Vector<double, 3>& delta) { return x.retract(delta); }
};

class Point2 : public BaseVertex<Point2, 2, Vector<double, 2>> {
 public:
  static Vector<double, 2> oplus(const Vector<double, 2>& x, const Vector<double, 2>& delta) { return x + delta; }
};

class Pose3 : public BaseVertex<Pose3, 6, SE3<double>> {
 public:
  static SE3<double> oplus(const SE3<double>& x, const Vector<double, 6>& delta) { return x.retract(delta); }
};

class Offset2 : public BaseParameter<Offset2, SE2<double>> {};
class Scale : public BaseParameter<Scale, double> {};

class Odometry2 : public BaseEdge<Odometry2, 3, SE2<double>, Pose2, Pose2> {
 public:
  static Vector<double, 3> computeError(const SE2<double>& z, const SE2<double>& from, const SE2<double>& to) {
    return (z.inverse() * (from.inverse() * to)).toVector();
  }
};

class Sighting2 : public BaseEdge<Sighting2, 2, Vector<double, 2>, Pose2, Point2> {
 public:
  static Vector<double, 2> computeError(const Vector<double, 2>& z, const SE2<double>& pose,
                                        const Vector<double, 2>& point) {
    return pose.inverse() * point - z;
  }
};

class OffsetSighting2 : public BaseEdge<OffsetSighting2, 2, Vector<double, 2>, Pose2, Point2> {
 public:
  using Parameters = ParameterList<Offset2>;
  static Vector<double, 2> computeError(const Vector<double, 2>& z, const SE2<double>& offset, const SE2<double>& pose,
                                        const Vector<double, 2>& point) {
    return (pose * offset).inverse() * point - z;
  }
};

class Prior2 : public BaseEdge<Prior2, 2, Vector<double, 2>, Point2> {
 public:
  static Vector<double, 2> computeError(const Vector<double, 2>& z, const Vector<double, 2>& point) {
    return point - z;
  }
};

class Odometry3 : public BaseEdge<Odometry3, 6, SE3<double>, Pose3, Pose3> {
 public:
  static Vector<double, 6> computeError(const SE3<double>& z, const SE3<double>& from, const SE3<double>& to) {
    return (z.inverse() * (from.inverse() * to)).log();
  }
};

/// A pose sees any number of points at once: `|| n x1 y1 …`, then the information of 2n numbers.
class Panorama2 : public BaseEdge<Panorama2, Dynamic, std::vector<double>, Pose2, AnyNumberOf<Point2>> {
 public:
  Vector<double, Dynamic> computeError(const std::vector<double>& z, const SE2<double>& pose,
                                       std::span<const Vector<double, 2>> points) const {
    Vector<double, Dynamic> error(2 * static_cast<int>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      error.segment<2>(2 * static_cast<int>(i)) =
          pose.inverse() * points[i] - Vector<double, 2>(z[2 * i], z[2 * i + 1]);
    }
    return error;
  }

  static std::vector<Field> fields() { return {{"count", "", "of points"}}; }
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

/// Knows all of these, the Huber kernel and one with a shape, "Shaped".
std::shared_ptr<Registry> makeRegistry();

}  // namespace quiver::test
