#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>

namespace quiver {

/// A point of the plane in the world. Tangent: (x, y) in metres along the world's axes.
class VertexXY : public BaseVertex<VertexXY, 2, Vector<double, 2>> {
 public:
  static constexpr std::array tangent{"x [m]", "y [m]"};

  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return Vector<S, 2>(x[0] + delta[0], x[1] + delta[1]);
  }

  static Vector<double, 2> place(const Vector<double, 2>& x) { return x; }

  static Matrix<double, 2, gaugeDirections> gaugeGenerators(const Vector<double, 2>& x) {
    Matrix<double, 2, gaugeDirections> G = Matrix<double, 2, gaugeDirections>::Zero();
    G(0, gaugeX) = 1.0;
    G(1, gaugeY) = 1.0;
    G.col(gaugeYaw) << -x[1], x[0];
    G.col(gaugeScale) = x;
    return G;
  }
};

}  // namespace quiver
