#pragma once

#include <array>

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam3d/addons/vertex_se3_euler.h>
#include <quiver/types_slam3d/edge_se3.h>

namespace quiver {

/// EdgeSE3 that stands in files as x y z roll pitch yaw with an information matrix in these coordinates (g2o's EDGE3).
/// Inside, the information is Jᵀ Ω J with J = ∂(t, euler)/∂(t, q_xyz) at the measurement, as g2o's; what was read is
/// written again as it was while measurement and information are unchanged.
class EdgeSE3Euler : public BaseEdge<EdgeSE3Euler, 6, SE3<double>, VertexSE3Euler, VertexSE3Euler> {
 public:
  static constexpr bool lanes = true;
  /// The line's information matrix is read and written here, since it is another.
  static constexpr bool informationInFile = false;

  template <typename S>
  static Vector<S, 6> computeError(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to) {
    return EdgeSE3::computeError<S>(z, from, to);
  }
  template <typename S>
  static void linearizeOplus(const SE3<S>& z, const SE3<S>& from, const SE3<S>& to, Matrix<S, 6, 6>& J0,
                             Matrix<S, 6, 6>& J1) {
    EdgeSE3::linearizeOplus<S>(z, from, to, J0, J1);
  }
  static bool initialEstimate(int to, const SE3<double>& z, SE3<double>& first, SE3<double>& second) {
    return EdgeSE3::initialEstimate(to, z, first, second);
  }

  static std::vector<Field> fields();
  void read(FieldReader& reader);
  void write(FieldWriter& writer) const;

 private:
  /// x y z roll pitch yaw and the upper triangle, as read last.
  std::array<double, 27> line_{};
};

}  // namespace quiver
