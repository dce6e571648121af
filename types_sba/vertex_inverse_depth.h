#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>

namespace quiver {

/// A point in the frame of the pose it is anchored in, ψ = (x/z, y/z, 1/z): y = (ψ₁, ψ₂, 1) / ψ₃. ψ₃ = 0 is a point at
/// infinity.
class VertexInverseDepth : public BaseVertex<VertexInverseDepth, 3, Vector<double, 3>> {
 public:
  static constexpr std::array tangent{"x/z []", "y/z []", "inverse depth [1/m]"};

  template <typename S>
  static Vector<S, 3> oplus(const Vector<S, 3>& x, const Vector<S, 3>& delta) {
    return Vector<S, 3>(x[0] + delta[0], x[1] + delta[1], x[2] + delta[2]);
  }
  /// Only a change of scale is felt.
  static Matrix<double, 3, gaugeDirections> gaugeGenerators(const Vector<double, 3>& x) {
    Matrix<double, 3, gaugeDirections> G = Matrix<double, 3, gaugeDirections>::Zero();
    G(2, gaugeScale) = -x[2];
    return G;
  }
  static std::vector<Field> fields() { return {{"x/z", "", ""}, {"y/z", "", ""}, {"1/z", "1/m", ""}}; }
};

}  // namespace quiver
