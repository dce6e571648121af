#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/models/camera_model.h>
#include <quiver/types_sba/stereo_camera.h>
#include <quiver/types_slam3d/vertex_se3.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

namespace detail {

/// Whether a camera of the model sees a point of its frame: in front of it; a fisheye also beside and behind.
template <typename Model>
bool sees(const Vector<double, 3>& p) {
  if constexpr (std::is_same_v<Model, CameraFisheye>) return p[2] > 0.0 || p[0] != 0.0 || p[1] != 0.0;
  if constexpr (std::is_same_v<Model, CameraSnavely>) return CameraSnavely::isDepthPositive<double>(p);
  return p[2] > 0.0;
}

template <typename Model, typename S>
inline Vector<S, 2> modelError(const Vector<S, 2>& z, const Vector<S, Model::intrinsicCount>& k, const SE3<S>& pose,
                               const Vector<S, 3>& point) {
  return difference<S, 2>(Model::template project<S>(k, pose.actInverse(point)), z);
}

/// e = π(X⁻¹ l) − z with intrinsics that are a parameter.
template <typename Edge, typename Parameter>
class ModelProjection : public BaseEdge<Edge, 2, Vector<double, 2>, VertexSE3, VertexXYZ> {
 public:
  using Model = typename Parameter::Model;
  using Parameters = ParameterList<Parameter>;
  static constexpr bool lanes = true;
  static constexpr int count = Model::intrinsicCount;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, count>& k, const SE3<S>& pose,
                                   const Vector<S, 3>& point) {
    return modelError<Model, S>(z, k, pose, point);
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, count>& k, const SE3<S>& pose,
                             const Vector<S, 3>& point, Matrix<S, 2, 6>& J0, Matrix<S, 2, 3>& J1) {
    const Vector<S, 3> p = pose.actInverse(point);
    projectionJacobians<S, 2>(Model::template pointJacobian<S>(k, p), pose, p, J0, J1);
  }
  static bool isDepthPositive(const Vector<double, 2>&, const Vector<double, count>&, const SE3<double>& pose,
                              const Vector<double, 3>& point) {
    return sees<Model>(pose.actInverse(point));
  }
  static std::vector<Field> fields() { return pixelFields<2>(); }
};

/// e = π(X⁻¹ l) − z with intrinsics that are the third vertex.
template <typename Edge, typename Vertex>
class ModelProjectionIntrinsics : public BaseEdge<Edge, 2, Vector<double, 2>, VertexSE3, VertexXYZ, Vertex> {
 public:
  using Model = typename Vertex::Model;
  static constexpr bool lanes = true;
  static constexpr int count = Model::intrinsicCount;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const SE3<S>& pose, const Vector<S, 3>& point,
                                   const Vector<S, count>& k) {
    return modelError<Model, S>(z, k, pose, point);
  }
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const SE3<S>& pose, const Vector<S, 3>& point,
                             const Vector<S, count>& k, Matrix<S, 2, 6>& J0, Matrix<S, 2, 3>& J1,
                             Matrix<S, 2, count>& J2) {
    const Vector<S, 3> p = pose.actInverse(point);
    projectionJacobians<S, 2>(Model::template pointJacobian<S>(k, p), pose, p, J0, J1);
    J2 = Model::template intrinsicsJacobian<S>(k, p);
  }
  static bool isDepthPositive(const Vector<double, 2>&, const SE3<double>& pose, const Vector<double, 3>& point,
                              const Vector<double, count>&) {
    return sees<Model>(pose.actInverse(point));
  }
  static std::vector<Field> fields() { return pixelFields<2>(); }
};

}  // namespace detail

// A pixel of a point seen from a pose, camera to world, by each camera model: e = π(X⁻¹ l) − z. The intrinsics are a
// parameter, or a vertex that is estimated.
class EdgeProjectPinhole : public detail::ModelProjection<EdgeProjectPinhole, ParameterPinhole> {};
class EdgeProjectBrown : public detail::ModelProjection<EdgeProjectBrown, ParameterBrown> {};
class EdgeProjectFisheye : public detail::ModelProjection<EdgeProjectFisheye, ParameterFisheye> {};
class EdgeProjectSnavely : public detail::ModelProjection<EdgeProjectSnavely, ParameterSnavely> {};
class EdgeProjectPinholeIntrinsics
    : public detail::ModelProjectionIntrinsics<EdgeProjectPinholeIntrinsics, VertexPinhole> {};
class EdgeProjectBrownIntrinsics : public detail::ModelProjectionIntrinsics<EdgeProjectBrownIntrinsics, VertexBrown> {};
class EdgeProjectFisheyeIntrinsics
    : public detail::ModelProjectionIntrinsics<EdgeProjectFisheyeIntrinsics, VertexFisheye> {};
class EdgeProjectSnavelyIntrinsics
    : public detail::ModelProjectionIntrinsics<EdgeProjectSnavelyIntrinsics, VertexSnavely> {};

}  // namespace quiver
