#pragma once

#include <array>

#include <quiver/core/graph/parameter.h>
#include <quiver/core/registry/value_fields.h>
#include <quiver/geometry/se3.h>

namespace quiver {

namespace detail {

/// The camera's pose in the body from its numbers: x y z qx qy qz qw, then others.
template <typename Numbers>
inline auto cameraPose(const Numbers& n) {
  using S = typename Numbers::Scalar;
  return SE3<S>(SO3<S>::fromUnit(n[3], n[4], n[5], n[6]), Vector<S, 3>(n[0], n[1], n[2]));
}

/// Reads a pose, then fx fy cx cy, all or none, and behind these what else there is; what the line leaves out keeps its
/// value.
template <int N>
inline void readCamera(FieldReader& reader, Vector<double, N>& values) {
  SE3<double> pose;
  ValueFields<SE3<double>>::read(reader, pose);
  values.template head<7>() = pose.toVector();
  if (!reader.atEnd()) reader.reals({values.data() + 7, 4});
  for (int i = 11; i < N && !reader.atEnd(); ++i) values[i] = reader.real();
}

inline std::vector<Field> cameraFields() {
  std::vector<Field> fields = ValueFields<SE3<double>>::fields();
  for (const char* name : {"fx", "fy", "cx", "cy"})
    fields.push_back({name, "px", "all four may be left out, with what follows"});
  return fields;
}

}  // namespace detail

/// A pinhole camera in the body, z forward: its pose (x y z qx qy qz qw), then fx fy cx cy (g2o's PARAMS_CAMERACALIB,
/// 1 1 0.5 0.5 unless given).
class ParameterCamera : public BaseParameter<ParameterCamera, Vector<double, 11>> {
 public:
  ParameterCamera() {
    Vector<double, 11> value;
    value << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.5;
    setValue(value);
  }
  static std::vector<Field> fields() { return detail::cameraFields(); }
  void read(FieldReader& reader) {
    Vector<double, 11> numbers = value();
    detail::readCamera(reader, numbers);
    setValue(numbers);
  }
  void write(FieldWriter& writer) const { writer.reals({values(), 11}); }
};

/// A stereo camera in the body: as ParameterCamera, then the baseline in metres (g2o's PARAMS_STEREOCAMERACALIB, 0.075
/// unless given).
class ParameterStereoCamera : public BaseParameter<ParameterStereoCamera, Vector<double, 12>> {
 public:
  ParameterStereoCamera() {
    Vector<double, 12> value;
    value << 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.075;
    setValue(value);
  }
  static std::vector<Field> fields() {
    std::vector<Field> fields = detail::cameraFields();
    fields.push_back({"baseline", "m", "may be left out"});
    return fields;
  }
  void read(FieldReader& reader) {
    Vector<double, 12> numbers = value();
    detail::readCamera(reader, numbers);
    setValue(numbers);
  }
  void write(FieldWriter& writer) const { writer.reals({values(), 12}); }
};

}  // namespace quiver
