#pragma once

#include <memory>

#include <quiver/core/graph/graph.h>

namespace quiver::test {

/// A view: rotation vector and translation, small enough not to need a group.
class VertexView : public BaseVertex<VertexView, 6, Vector<double, 6>> {
 public:
  template <typename S>
  static Vector<S, 6> oplus(const Vector<S, 6>& x, const Vector<S, 6>& delta) {
    return x + delta;
  }
};

class VertexPlace : public BaseVertex<VertexPlace, 3, Vector<double, 3>> {
 public:
  template <typename S>
  static Vector<S, 3> oplus(const Vector<S, 3>& x, const Vector<S, 3>& delta) {
    return x + delta;
  }
};

/// Focal length and radial distortion that all views share.
class VertexLens : public BaseVertex<VertexLens, 2, Vector<double, 2>> {
 public:
  template <typename S>
  static Vector<S, 2> oplus(const Vector<S, 2>& x, const Vector<S, 2>& delta) {
    return x + delta;
  }
};

/// A pixel: the point is turned by the rotation vector to second order, moved, divided by its depth, and distorted.
class EdgePixel : public BaseEdge<EdgePixel, 2, Vector<double, 2>, VertexView, VertexPlace, VertexLens> {
 public:
  static constexpr bool lanes = true;
  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 6>& view, const Vector<S, 3>& point,
                                   const Vector<S, 2>& lens) {
    const auto cross = [&](const Vector<S, 3>& v) {
      return Vector<S, 3>(view[1] * v[2] - view[2] * v[1], view[2] * v[0] - view[0] * v[2],
                          view[0] * v[1] - view[1] * v[0]);
    };
    const Vector<S, 3> first = cross(point);
    const Vector<S, 3> second = cross(first);
    Vector<S, 3> p;
    for (int i = 0; i < 3; ++i) p[i] = point[i] + first[i] + S(0.5) * second[i] + view[3 + i];
    const S x = p[0] / p[2];
    const S y = p[1] / p[2];
    const S scale = lens[0] * (S(1.0) + lens[1] * (x * x + y * y));
    return Vector<S, 2>(scale * x - z[0], scale * y - z[1]);
  }
};

/// The difference of two points.
class EdgeBetween : public BaseEdge<EdgeBetween, 3, Vector<double, 3>, VertexPlace, VertexPlace> {
 public:
  template <typename S>
  static Vector<S, 3> computeError(const Vector<S, 3>& z, const Vector<S, 3>& a, const Vector<S, 3>& b) {
    return b - a - z;
  }
};

/// The difference of two views.
class EdgeMotion : public BaseEdge<EdgeMotion, 6, Vector<double, 6>, VertexView, VertexView> {
 public:
  template <typename S>
  static Vector<S, 6> computeError(const Vector<S, 6>& z, const Vector<S, 6>& a, const Vector<S, 6>& b) {
    return b - a - z;
  }
};

/// Views have ids from 0, the lens 500, points from firstPoint on.
constexpr std::int64_t firstPoint = 1000;
constexpr std::int64_t lensId = 500;

struct BundleShape {
  int cameras = 12;
  int points = 200;
  /// So many points, the first ones, are seen by one view alone.
  int seenOnce = 0;
  /// So many of the following points are tied to the ones before them by an edge.
  int joinedPoints = 0;
};

/// Views along a line that look the same way, points before them, noise of half a pixel, a start some way off; the
/// first view is fixed and consecutive ones are tied by their measured motion, so that nothing is free.
Graph bundle(const BundleShape& shape);

}  // namespace quiver::test
