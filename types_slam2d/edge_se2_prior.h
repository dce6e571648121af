#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/vertex_se2.h>

namespace quiver {

/// A pose measured in the world: e = Z⁻¹ X as (x, y, θ) (g2o's EDGE_PRIOR_SE2).
class EdgePriorSE2 : public BaseEdge<EdgePriorSE2, 3, SE2<double>, VertexSE2> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 3> computeError(const SE2<S>& z, const SE2<S>& x) {
    return z.between(x).toVector();
  }

  /// [R_zᵀ R, 0; 0, 1]
  template <typename S>
  static void linearizeOplus(const SE2<S>& z, const SE2<S>& x, Matrix<S, 3, 3>& J) {
    const SO2<S>&a = z.rotation(), &b = x.rotation();
    J(0, 0) = J(1, 1) = a.cosine() * b.cosine() + a.sine() * b.sine();
    J(1, 0) = a.cosine() * b.sine() - a.sine() * b.cosine();
    J(0, 1) = -J(1, 0);
    J(0, 2) = J(1, 2) = J(2, 0) = J(2, 1) = S(0.0);
    J(2, 2) = S(1.0);
  }

  static bool initialEstimate(int, const SE2<double>& z, SE2<double>& x) {
    x = z;
    return true;
  }
};

/// A pose's position measured in the world: e = t − z (g2o's EDGE_PRIOR_SE2_XY).
class EdgePriorSE2XY : public BaseEdge<EdgePriorSE2XY, 2, Vector<double, 2>, VertexSE2> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE2<S>& x) {
    return Vector<S, 2>(x.x() - z[0], x.y() - z[1]);
  }

  /// [R, 0]
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE2<S>& x, Matrix<S, 2, 3>& J) {
    J(0, 0) = J(1, 1) = x.rotation().cosine();
    J(1, 0) = x.rotation().sine();
    J(0, 1) = -J(1, 0);
    J(0, 2) = J(1, 2) = S(0.0);
  }
};

}  // namespace quiver
