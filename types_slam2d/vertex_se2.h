#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/se2.h>

namespace quiver {

/// A pose in the plane, body to world. Tangent: (x, y) in metres along the body's axes, then the heading in radians.
class VertexSE2 : public BaseVertex<VertexSE2, 3, SE2<double>> {
 public:
  static constexpr bool lanes = true;
  static constexpr std::array tangent{"x [m]", "y [m]", "theta [rad]"};

  /// t + R ρ, wrap(θ + φ).
  template <typename S>
  static SE2<S> oplus(const SE2<S>& x, const Vector<S, 3>& delta) {
    return x.retract(delta);
  }

  /// World translations along x and y, rotation about the world's origin, scale; seen in the body.
  static Matrix<double, 3, gaugeDirections> gaugeGenerators(const SE2<double>& x) {
    Matrix<double, 3, gaugeDirections> G = Matrix<double, 3, gaugeDirections>::Zero();
    const Vector<double, 2> t = x.translation();
    const auto inBody = [&](double a, double b) { return x.rotation().actInverse(Vector<double, 2>(a, b)); };
    G.col(gaugeX).head<2>() = inBody(1.0, 0.0);
    G.col(gaugeY).head<2>() = inBody(0.0, 1.0);
    G.col(gaugeYaw) << inBody(-t[1], t[0]), 1.0;
    G.col(gaugeScale).head<2>() = inBody(t[0], t[1]);
    return G;
  }
};

}  // namespace quiver
