#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/so2.h>

namespace quiver {

/// A line of the plane: the points p with n(θ)·p = ρ, n(θ) = (cos θ, sin θ). Estimate and tangent: (θ, ρ), radians and
/// metres.
class VertexLine2D : public BaseVertex<VertexLine2D, 2, Vector<double, 2>> {
 public:
  static constexpr std::array tangent{"theta [rad]", "rho [m]"};

  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return Vector<S, 2>(wrapAngle(S(x[0] + delta[0])), x[1] + delta[1]);
  }

  static Matrix<double, 2, gaugeDirections> gaugeGenerators(const Vector<double, 2>& x) {
    Matrix<double, 2, gaugeDirections> G = Matrix<double, 2, gaugeDirections>::Zero();
    G(1, gaugeX) = std::cos(x[0]);
    G(1, gaugeY) = std::sin(x[0]);
    G(0, gaugeYaw) = 1.0;
    G(1, gaugeScale) = x[1];
    return G;
  }

  /// Ids of the vertices at the ends of the part that was seen, −1 for none: for drawing only.
  std::int64_t firstEnd() const { return ends_[0]; }
  std::int64_t secondEnd() const { return ends_[1]; }
  void setEnds(std::int64_t first, std::int64_t second) { ends_ = {first, second}; }

  static std::vector<Field> fields() {
    return {{"theta", "rad", "direction of the normal"},
            {"rho", "m", "distance from the origin along the normal"},
            {"firstEnd", "", "id of a vertex or -1; both ends may be left out"},
            {"secondEnd", "", "id of a vertex or -1; both ends may be left out"}};
  }
  void read(FieldReader& reader) {
    const double theta = reader.real();
    setEstimate(Vector<double, 2>(theta, reader.real()));
    ends_ = {-1, -1};
    if (reader.atEnd()) return;
    for (std::int64_t& end : ends_) end = reader.integer();
  }
  void write(FieldWriter& writer) const {
    writer.reals({values(), 2});
    for (const std::int64_t end : ends_) writer.integer(end);
  }

 private:
  std::array<std::int64_t, 2> ends_{-1, -1};
};

}  // namespace quiver
