#pragma once

#include <array>

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/expmap/vertex_se3_expmap.h>
#include <quiver/types_sba/stereo_camera.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

namespace detail {

/// Numbers that a pixel of `Rows` numbers needs beside it: fx fy cx cy, and f_x times the baseline for a stereo pair.
template <int Rows>
constexpr int intrinsicsOf = Rows + 2;

/// The camera that stands behind the pixel in a measurement.
template <int Rows, typename Measurement>
inline auto cameraOf(const Measurement& m) {
  using S = typename Measurement::Scalar;
  StereoCamera<S> camera{m[Rows], m[Rows + 1], m[Rows + 2], m[Rows + 3], S(0.0)};
  if constexpr (Rows == 3) camera.shift = m[Rows + 4];
  return camera;
}

template <int Rows, typename Measurement>
inline auto pixelError(const Measurement& m, const Vector<typename Measurement::Scalar, 3>& p) {
  using S = typename Measurement::Scalar;
  const Vector<S, Rows> seen = cameraOf<Rows>(m).template project<Rows>(p);
  Vector<S, Rows> e;
  QUIVER_UNROLL for (int r = 0; r < Rows; ++r) e[r] = m[r] - seen[r];
  return e;
}

/// A measurement whose first `Rows` numbers are g2o's and whose others g2o loses: they stand behind the information.
template <typename Edge, int Rows, int Size, typename... Vertices>
class TailedProjection : public BaseEdge<Edge, Rows, Vector<double, Size>, Vertices...> {
 public:
  static constexpr bool lanes = true;

  static std::vector<Field> fields() { return pixelFields<Rows>(); }
  static std::vector<Field> tailFields() {
    std::vector<Field> fields{
        {"fx", "px", "g2o does not write what follows"}, {"fy", "px", ""}, {"cx", "px", ""}, {"cy", "px", ""}};
    if (Rows == 3) fields.push_back({"bf", "px m", "baseline times fx"});
    if (Size > Rows + intrinsicsOf<Rows>) {
      for (const char* name : {"x", "y", "z"}) fields.push_back({name, "m", "of the point, in the world"});
    }
    return fields;
  }
  void read(FieldReader& reader) {
    Vector<double, Size> m = this->measurement();
    reader.reals({m.data(), Rows});
    this->setMeasurement(m);
  }
  void write(FieldWriter& writer) const { writer.reals({this->measurementStore().values(), Rows}); }
  void readTail(FieldReader& reader) {
    Vector<double, Size> m = this->measurement();
    if (Edge::tailMayBeMissing && reader.atEnd()) {
      const double usual[4] = {1.0, 1.0, 0.5, 0.5};
      for (int i = 0; i < 4; ++i) m[Rows + i] = usual[i];
    } else {
      reader.reals({m.data() + Rows, Size - Rows});
    }
    this->setMeasurement(m);
  }
  void writeTail(FieldWriter& writer) const { writer.reals({this->measurementStore().values() + Rows, Size - Rows}); }
};

/// What the edges between a point and a pose share: e = z − view(X⁻¹ l).
template <typename Edge, int Rows>
class PointPoseProjection : public TailedProjection<Edge, Rows, Rows + intrinsicsOf<Rows>, VertexXYZ, VertexSE3Expmap> {
 public:
  static constexpr int size = Rows + intrinsicsOf<Rows>;

  template <typename S>
  static Vector<S, Rows> computeError(const Vector<S, size>& m, const Vector<S, 3>& point, const SE3<S>& pose) {
    return pixelError<Rows>(m, pose.actInverse(point));
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, size>& m, const Vector<S, 3>& point, const SE3<S>& pose,
                             Matrix<S, Rows, 3>& J0, Matrix<S, Rows, 6>& J1) {
    const Vector<S, 3> p = pose.actInverse(point);
    projectionJacobians<S, Rows>(cameraOf<Rows>(m).template pointJacobian<Rows>(p, -1.0), pose, p, J1, J0);
  }
  static bool isDepthPositive(const Vector<double, size>&, const Vector<double, 3>& point, const SE3<double>& pose) {
    return pose.actInverse(point)[2] > 0.0;
  }
  /// A stereo pair tells the point.
  static bool initialEstimate(int to, const Vector<double, size>& m, Vector<double, 3>& point, SE3<double>& pose) {
    if constexpr (Rows == 3) {
      if (to != 0 || !triangulate(cameraOf<Rows>(m), Vector<double, 3>(m.template head<3>()), point)) return false;
      point = pose * point;
      return true;
    }
    return false;
  }
};

/// What the edges on a pose alone share: the point is part of the measurement.
template <typename Edge, int Rows>
class PoseProjection : public TailedProjection<Edge, Rows, Rows + intrinsicsOf<Rows> + 3, VertexSE3Expmap> {
 public:
  static constexpr int size = Rows + intrinsicsOf<Rows> + 3;

  template <typename S>
  static Vector<S, Rows> computeError(const Vector<S, size>& m, const SE3<S>& pose) {
    return pixelError<Rows>(m, pose.actInverse(pointOf(m)));
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, size>& m, const SE3<S>& pose, Matrix<S, Rows, 6>& J) {
    const Vector<S, 3> p = pose.actInverse(pointOf(m));
    seenPointByPose<S, Rows>(cameraOf<Rows>(m).template pointJacobian<Rows>(p, -1.0), p, J);
  }
  static bool isDepthPositive(const Vector<double, size>& m, const SE3<double>& pose) {
    return pose.actInverse(pointOf(m))[2] > 0.0;
  }

 private:
  template <typename Measurement>
  static auto pointOf(const Measurement& m) {
    return Vector<typename Measurement::Scalar, 3>(m[size - 3], m[size - 2], m[size - 1]);
  }
};

}  // namespace detail

/// A pixel of a point: e = z − π(X⁻¹ l) (g2o's EDGE_SE3_PROJECT_XYZ:EXPMAP, which does not write fx fy cx cy;
/// 1 1 0.5 0.5 where they are missing). Measurement: u v fx fy cx cy.
class EdgeSE3ProjectXYZ : public detail::PointPoseProjection<EdgeSE3ProjectXYZ, 2> {
 public:
  static constexpr bool tailMayBeMissing = true;
};

/// A pixel of a point and its column in the right image (g2o's EDGE_STEREO_SE3_PROJECT_XYZ:EXPMAP). Measurement:
/// u v u_right fx fy cx cy bf.
class EdgeStereoSE3ProjectXYZ : public detail::PointPoseProjection<EdgeStereoSE3ProjectXYZ, 3> {
 public:
  static constexpr bool tailMayBeMissing = false;
};

/// A pixel of a known point (g2o's EDGE_SE3_PROJECT_XYZONLYPOSE:EXPMAP). Measurement: u v fx fy cx cy x y z.
class EdgeSE3ProjectXYZOnlyPose : public detail::PoseProjection<EdgeSE3ProjectXYZOnlyPose, 2> {
 public:
  static constexpr bool tailMayBeMissing = false;
};

/// A known point in both images (g2o's EDGE_STEREO_SE3_PROJECT_XYZONLYPOSE:EXPMAP). Measurement: u v u_right
/// fx fy cx cy bf x y z.
class EdgeStereoSE3ProjectXYZOnlyPose : public detail::PoseProjection<EdgeStereoSE3ProjectXYZOnlyPose, 3> {
 public:
  static constexpr bool tailMayBeMissing = false;
};

}  // namespace quiver
