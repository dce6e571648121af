#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>

namespace quiver {

/// A segment of the plane: its end points (x₁, y₁, x₂, y₂) in the world, all in metres.
class VertexSegment2D : public BaseVertex<VertexSegment2D, 4, Vector<double, 4>> {
 public:
  static constexpr std::array tangent{"x1 [m]", "y1 [m]", "x2 [m]", "y2 [m]"};

  template <typename S>
  static Vector<S, 4> oplus(const Vector<S, 4>& x, const Vector<S, 4>& delta) {
    return x + delta;
  }

  static Matrix<double, 4, gaugeDirections> gaugeGenerators(const Vector<double, 4>& x) {
    Matrix<double, 4, gaugeDirections> G = Matrix<double, 4, gaugeDirections>::Zero();
    G.col(gaugeX) << 1.0, 0.0, 1.0, 0.0;
    G.col(gaugeY) << 0.0, 1.0, 0.0, 1.0;
    G.col(gaugeYaw) << -x[1], x[0], -x[3], x[2];
    G.col(gaugeScale) = x;
    return G;
  }

  static std::vector<Field> fields() { return {{"x1", "m", ""}, {"y1", "m", ""}, {"x2", "m", ""}, {"y2", "m", ""}}; }
};

}  // namespace quiver
