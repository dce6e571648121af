#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_slam2d/vertex_xy.h>

namespace quiver {

/// The way from one point to another in the world's axes: e = (l₂ − l₁) − z (g2o's EDGE_POINTXY).
class EdgeXY : public BaseEdge<EdgeXY, 2, Vector<double, 2>, VertexXY, VertexXY> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& from, const Vector<S, 2>& to) {
    return to - from - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 2>&, const Vector<S, 2>&, Matrix<S, 2, 2>& J0,
                             Matrix<S, 2, 2>& J1) {
    J0 = -Matrix<S, 2, 2>::Identity();
    J1.setIdentity();
  }

  static bool initialEstimate(int to, const Vector<double, 2>& z, Vector<double, 2>& first, Vector<double, 2>& second) {
    if (to == 1) {
      second = first + z;
    } else {
      first = second - z;
    }
    return true;
  }
};

/// A point measured in the world: e = l − z (g2o's EDGE_PRIOR_XY).
class EdgePriorXY : public BaseEdge<EdgePriorXY, 2, Vector<double, 2>, VertexXY> {
 public:
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 2>& point) {
    return point - z;
  }

  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 2>&, Matrix<S, 2, 2>& J) {
    J.setIdentity();
  }

  static bool initialEstimate(int, const Vector<double, 2>& z, Vector<double, 2>& point) {
    point = z;
    return true;
  }
};

}  // namespace quiver
