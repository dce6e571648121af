#pragma once

#include <array>

#include <quiver/core/graph/parameter.h>
#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/camera_brown.h>
#include <quiver/geometry/camera_fisheye.h>
#include <quiver/geometry/camera_pinhole.h>
#include <quiver/geometry/camera_snavely.h>

namespace quiver {

namespace detail {

/// Names of a camera model's intrinsics.
template <typename Model>
struct IntrinsicNames;
template <>
struct IntrinsicNames<CameraPinhole> {
  static constexpr std::array names{"fx [px]", "fy [px]", "cx [px]", "cy [px]"};
};
template <>
struct IntrinsicNames<CameraBrown> {
  static constexpr std::array names{"fx [px]", "fy [px]", "cx [px]", "cy [px]", "k1 []",
                                    "k2 []",   "p1 []",   "p2 []",   "k3 []"};
};
template <>
struct IntrinsicNames<CameraFisheye> {
  static constexpr std::array names{"fx [px]", "fy [px]", "cx [px]", "cy [px]", "k1 []", "k2 []", "k3 []", "k4 []"};
};
template <>
struct IntrinsicNames<CameraSnavely> {
  static constexpr std::array names{"f [px]", "k1 []", "k2 []"};
};

/// "fx [px]" as a field of a file.
template <typename Model>
std::vector<Field> intrinsicFields() {
  std::vector<Field> fields;
  for (const std::string_view name : IntrinsicNames<Model>::names) {
    const std::size_t blank = name.find(' ');
    fields.push_back(
        {std::string(name.substr(0, blank)), std::string(name.substr(blank + 2, name.size() - blank - 3)), ""});
  }
  return fields;
}

template <typename Model>
using Intrinsics = Vector<double, Model::intrinsicCount>;

/// Focal lengths 1, the rest 0.
template <typename Model>
Intrinsics<Model> usualIntrinsics() {
  Intrinsics<Model> k = Intrinsics<Model>::Zero();
  k[0] = 1.0;
  if constexpr (Model::intrinsicCount > 3) k[1] = 1.0;
  return k;
}

/// Intrinsics that are constant; any number of edges may share them.
template <typename Parameter, typename CameraModel>
class ModelParameter : public BaseParameter<Parameter, Intrinsics<CameraModel>> {
 public:
  using Model = CameraModel;
  ModelParameter() { this->setValue(usualIntrinsics<CameraModel>()); }
  static std::vector<Field> fields() { return intrinsicFields<CameraModel>(); }
};

/// Intrinsics that are estimated; any number of cameras may share them. To keep some of them, hold their directions.
template <typename Derived, typename CameraModel>
class ModelVertex : public BaseVertex<Derived, CameraModel::intrinsicCount, Intrinsics<CameraModel>> {
 public:
  using Model = CameraModel;
  static constexpr int count = CameraModel::intrinsicCount;
  static constexpr auto tangent = IntrinsicNames<CameraModel>::names;

  template <typename S>
  static Vector<S, count> oplus(const Vector<S, count>& x, const Vector<S, count>& delta) {
    Vector<S, count> moved;
    QUIVER_UNROLL for (int i = 0; i < count; ++i) moved[i] = x[i] + delta[i];
    return moved;
  }
  /// The world may move as it likes.
  static Matrix<double, count, gaugeDirections> gaugeGenerators(const Intrinsics<CameraModel>&) {
    return Matrix<double, count, gaugeDirections>::Zero();
  }
  static std::vector<Field> fields() { return intrinsicFields<CameraModel>(); }
};

}  // namespace detail

// Intrinsics as parameters and as vertices, in the order of the camera models of geometry/.
class ParameterPinhole : public detail::ModelParameter<ParameterPinhole, CameraPinhole> {};
class ParameterBrown : public detail::ModelParameter<ParameterBrown, CameraBrown> {};
class ParameterFisheye : public detail::ModelParameter<ParameterFisheye, CameraFisheye> {};
class ParameterSnavely : public detail::ModelParameter<ParameterSnavely, CameraSnavely> {};
class VertexPinhole : public detail::ModelVertex<VertexPinhole, CameraPinhole> {};
class VertexBrown : public detail::ModelVertex<VertexBrown, CameraBrown> {};
class VertexFisheye : public detail::ModelVertex<VertexFisheye, CameraFisheye> {};
class VertexSnavely : public detail::ModelVertex<VertexSnavely, CameraSnavely> {};

}  // namespace quiver
