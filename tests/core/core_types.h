#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include <quiver/core/graph/graph.h>
#include <quiver/types_slam2d/edge_se2.h>

namespace quiver::test {

/// A point in the plane.
class VertexPoint : public BaseVertex<VertexPoint, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
  static constexpr std::array tangent{"x [m]", "y [m]"};

  static Matrix<double, 2, gaugeDirections> gaugeGenerators(const Vector<double, 2>& x) {
    Matrix<double, 2, gaugeDirections> G = Matrix<double, 2, gaugeDirections>::Zero();
    G(0, gaugeX) = G(1, gaugeY) = 1.0;
    G.col(gaugeYaw) << -x[1], x[0];
    G.col(gaugeScale) = x;
    return G;
  }
};

/// A range from a pose to a point, in every form a type may have.
template <Jacobians form, bool inLanes>
class EdgeRange : public BaseEdge<EdgeRange<form, inLanes>, 1, double, VertexSE2, VertexPoint> {
 public:
  static constexpr Jacobians jacobians = form;
  static constexpr bool lanes = inLanes;

  template <typename S>
  static Vector<S, 1> computeError(const S& range, const SE2<S>& robot, const Vector<S, 2>& point) {
    return Vector<S, 1>((point - robot.translation()).norm() - range);
  }
  template <typename S>
  static void linearizeOplus(const S& /*range*/, const SE2<S>& robot, const Vector<S, 2>& point, Matrix<S, 1, 3>& J0,
                             Matrix<S, 1, 2>& J1) {
    const Vector<S, 2> d = point - robot.translation();
    const S length = d.norm();
    J1(0, 0) = d[0] / length, J1(0, 1) = d[1] / length;
    const Vector<S, 2> inBody = robot.rotation().actInverse(d);
    J0(0, 0) = -inBody[0] / length, J0(0, 1) = -inBody[1] / length, J0(0, 2) = S(0.0);
  }
};
using EdgeRangeNumeric = EdgeRange<Jacobians::numeric, false>;
using EdgeRangeDual = EdgeRange<Jacobians::dual, false>;
using EdgeRangeDualLanes = EdgeRange<Jacobians::dual, true>;
using EdgeRangeAnalytic = EdgeRange<Jacobians::analytic, false>;
using EdgeRangeAnalyticLanes = EdgeRange<Jacobians::analytic, true>;

/// A point measured outright.
class EdgePoint : public BaseEdge<EdgePoint, 2, Vector<double, 2>, VertexPoint> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& x) {
    return x - z;
  }
};

/// The same with a Jacobian of the wrong sign: nothing lowers its cost.
class EdgeWrong : public BaseEdge<EdgeWrong, 2, Vector<double, 2>, VertexPoint> {
 public:
  static Vector<double, 2> computeError(const Vector<double, 2>& z, const Vector<double, 2>& x) { return x - z; }
  static void linearizeOplus(const Vector<double, 2>&, const Vector<double, 2>&, Matrix<double, 2, 2>& J) {
    J = -Matrix<double, 2, 2>::Identity();
  }
};

/// A shift that edges share.
class ParameterShift : public BaseParameter<ParameterShift, Vector<double, 2>> {};

/// A point measured by a shifted sensor whose gain the edge itself holds: a member function.
class EdgeShifted : public BaseEdge<EdgeShifted, 2, Vector<double, 2>, VertexPoint> {
 public:
  using Parameters = ParameterList<ParameterShift>;
  double gain = 1.0;
  Vector<double, 2> computeError(const Vector<double, 2>& z, const Vector<double, 2>& shift,
                                 const Vector<double, 2>& x) const {
    return gain * x + shift - z;
  }
};

/// The mean of any number of points.
class EdgeMean : public BaseEdge<EdgeMean, 2, Vector<double, 2>, AnyNumberOf<VertexPoint>> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, std::span<const Vector<S, 2>> points) {
    Vector<S, 2> sum = points[0];
    for (std::size_t i = 1; i < points.size(); ++i) sum += points[i];
    return Vector<S, 2>(sum / S(static_cast<double>(points.size())) - z);
  }
};

/// Numbers whose count is known at run time.
class VertexNumbers : public BaseVertex<VertexNumbers, Dynamic, Vector<double, Dynamic>> {
 public:
  template <typename S>
  static Vector<S, Dynamic> oplus(const Vector<S, Dynamic>& x, const Vector<S, Dynamic>& delta) {
    return x + delta;
  }
  static std::vector<Field> fields() { return {{"values", "", "count, then the numbers"}}; }
  void read(FieldReader& reader) {
    Vector<double, Dynamic> x(reader.integer());
    for (double& value : x) value = reader.real();
    setEstimate(x);
  }
  void write(FieldWriter& writer) const {
    writer.integer(valueCount());
    writer.reals({values(), static_cast<std::size_t>(valueCount())});
  }
};

/// Squares of such numbers are all alike: an error of run-time dimension.
class EdgeSquares : public BaseEdge<EdgeSquares, Dynamic, double, VertexNumbers> {
 public:
  template <typename S>
  static Vector<S, Dynamic> computeError(const S& z, const Vector<S, Dynamic>& x) {
    Vector<S, Dynamic> error(x.size());
    for (int i = 0; i < x.size(); ++i) error[i] = x[i] * x[i] - z;
    return error;
  }
};

/// All of these, EDGE_SE2 and VERTEX_SE2, and the linear systems.
std::shared_ptr<Registry> makeRegistry();

inline Matrix<double, 1, 1> weight(double value) { return Matrix<double, 1, 1>(value); }
inline Matrix<double, 2, 2> weight2(double value = 1.0) { return value * Matrix<double, 2, 2>::Identity(); }
inline Matrix<double, 3, 3> weight3(double value = 1.0) { return value * Matrix<double, 3, 3>::Identity(); }

}  // namespace quiver::test
