#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/se3.h>

namespace quiver {

/// A pose in space, body to world. Tangent: (ρ, φ), metres along and radians about the body's axes.
class VertexSE3 : public BaseVertex<VertexSE3, 6, SE3<double>> {
 public:
  static constexpr bool lanes = true;
  static constexpr std::array tangent{"x [m]", "y [m]", "z [m]", "roll [rad]", "pitch [rad]", "yaw [rad]"};

  /// X Exp(ρ, φ).
  template <typename S>
  static SE3<S> oplus(const SE3<S>& x, const Vector<S, 6>& delta) {
    return x.retract(delta);
  }

  /// A motion Exp(ξ) of the world is Ad(X⁻¹) ξ in the body: ρ = Rᵀ(ρ_w + ω × t), φ = Rᵀω; scale moves t along itself.
  static Matrix<double, 6, gaugeDirections> gaugeGenerators(const SE3<double>& x) {
    Matrix<double, 6, gaugeDirections> G = Matrix<double, 6, gaugeDirections>::Zero();
    const Matrix<double, 3, 3> toBody = x.rotation().matrix().transpose();
    const Vector<double, 3> t = x.translation();
    G.block<3, 3>(0, gaugeX) = toBody;
    G.block<3, 3>(0, gaugeRoll) = toBody * -hat<double>(t);
    G.block<3, 3>(3, gaugeRoll) = toBody;
    G.col(gaugeScale).head<3>() = toBody * t;
    return G;
  }
};

}  // namespace quiver
