#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>

namespace quiver {

/// A point in the world. Tangent: (x, y, z) in metres along the world's axes.
class VertexXYZ : public BaseVertex<VertexXYZ, 3, Vector<double, 3>> {
 public:
  static constexpr std::array tangent{"x [m]", "y [m]", "z [m]"};

  template <typename S>
  static Vector<S, 3> oplus(const Vector<S, 3>& x, const Vector<S, 3>& delta) {
    return Vector<S, 3>(x[0] + delta[0], x[1] + delta[1], x[2] + delta[2]);
  }

  static Vector<double, 3> place(const Vector<double, 3>& x) { return x; }

  static Matrix<double, 3, gaugeDirections> gaugeGenerators(const Vector<double, 3>& x) {
    Matrix<double, 3, gaugeDirections> G = Matrix<double, 3, gaugeDirections>::Zero();
    G.block<3, 3>(0, gaugeX).setIdentity();
    G.block<3, 3>(0, gaugeRoll) = -hat<double>(x);
    G.col(gaugeScale) = x;
    return G;
  }
};

}  // namespace quiver
