#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <quiver/core/registry/fields.h>
#include <quiver/geometry/linear.h>
#include <quiver/geometry/se2.h>
#include <quiver/geometry/se3.h>
#include <quiver/geometry/sim3.h>

namespace quiver {

/// How a value stands in a file, by default: which numbers in which order. Specialise it for types of your own, or give
/// the vertex or edge `read` and `write`.
template <typename M>
struct ValueFields;

template <>
struct ValueFields<double> {
  static std::vector<Field> fields() { return {{"value", "", ""}}; }
  static void read(FieldReader& reader, double& value) { value = reader.real(); }
  static void write(const double& value, FieldWriter& writer) { writer.real(value); }
};

/// Row vectors and columns: one number an entry; matrices row by row.
template <int R, int C, int Options>
requires(R > 0 && C > 0) struct ValueFields<Eigen::Matrix<double, R, C, Options>> {
  using Value = Eigen::Matrix<double, R, C, Options>;
  static std::vector<Field> fields() {
    static constexpr std::array<const char*, 3> names{"x", "y", "z"};
    std::vector<Field> result;
    for (int i = 0; i < R * C; ++i) {
      result.push_back(
          {R * C <= 3 ? names[static_cast<std::size_t>(i)] : "value" + std::to_string(i), R * C <= 3 ? "m" : "", ""});
    }
    return result;
  }
  static void read(FieldReader& reader, Value& value) {
    std::array<double, static_cast<std::size_t>(R * C)> v;
    reader.reals(v);
    value = Eigen::Map<const Eigen::Matrix<double, R, C, C == 1 ? Eigen::ColMajor : Eigen::RowMajor>>(v.data());
  }
  static void write(const Value& value, FieldWriter& writer) {
    for (int r = 0; r < R; ++r) {
      for (int c = 0; c < C; ++c) writer.real(value(r, c));
    }
  }
};

/// x y θ. The angle is kept as it stands.
template <>
struct ValueFields<SE2<double>> {
  static std::vector<Field> fields() { return {{"x", "m", ""}, {"y", "m", ""}, {"theta", "rad", "counter-clockwise"}}; }
  static void read(FieldReader& reader, SE2<double>& value) {
    std::array<double, 3> v;
    reader.reals(v);
    value = SE2<double>(v[0], v[1], v[2]);
  }
  static void write(const SE2<double>& value, FieldWriter& writer) {
    writer.real(value.translation()[0]);
    writer.real(value.translation()[1]);
    writer.real(value.angle());
  }
};

template <>
struct ValueFields<SO2<double>> {
  static std::vector<Field> fields() { return {{"theta", "rad", "counter-clockwise"}}; }
  static void read(FieldReader& reader, SO2<double>& value) { value = SO2<double>(reader.real()); }
  static void write(const SO2<double>& value, FieldWriter& writer) { writer.real(value.angle()); }
};

namespace detail {

/// Types that take the place of their value's fields: both or neither.
template <typename T>
concept ReadsItself = requires(T& element, FieldReader& reader) {
  element.read(reader);
};
template <typename T>
concept WritesItself = requires(const T& element, FieldWriter& writer) {
  element.write(writer);
};

inline SO3<double> rotationOf(const FieldReader& reader, double x, double y, double z, double w) {
  const double square = x * x + y * y + z * z + w * w;
  if (!std::isfinite(square)) reader.fail("a quaternion this long is no rotation");
  if (!(square > 1e-12)) reader.fail("a quaternion of norm below 1e-6 is no rotation");
  return SO3<double>(x, y, z, w);
}

inline std::vector<Field> joined(std::vector<Field> first, const std::vector<Field>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace detail

/// qx qy qz qw, Hamilton. Normalised only if | |q|² − 1 | > 1e-14; its sign is kept.
template <>
struct ValueFields<SO3<double>> {
  static std::vector<Field> fields() {
    return {{"qx", "", "unit quaternion, Hamilton"}, {"qy", "", ""}, {"qz", "", ""}, {"qw", "", ""}};
  }
  static void read(FieldReader& reader, SO3<double>& value) {
    std::array<double, 4> q;
    reader.reals(q);
    value = detail::rotationOf(reader, q[0], q[1], q[2], q[3]);
  }
  static void write(const SO3<double>& value, FieldWriter& writer) {
    const Vector<double, 4> q = value.coefficients();
    for (int i = 0; i < 4; ++i) writer.real(q[i]);
  }
};

/// x y z, then the rotation.
template <>
struct ValueFields<SE3<double>> {
  static std::vector<Field> fields() {
    return detail::joined(ValueFields<Vector<double, 3>>::fields(), ValueFields<SO3<double>>::fields());
  }
  static void read(FieldReader& reader, SE3<double>& value) {
    std::array<double, 7> v;  // in one call: files are full of these
    reader.reals(v);
    value = SE3<double>(detail::rotationOf(reader, v[3], v[4], v[5], v[6]), Vector<double, 3>(v[0], v[1], v[2]));
  }
  static void write(const SE3<double>& value, FieldWriter& writer) {
    ValueFields<Vector<double, 3>>::write(value.translation(), writer);
    ValueFields<SO3<double>>::write(value.rotation(), writer);
  }
};

/// x y z, the rotation, then the scale, which must be positive.
template <>
struct ValueFields<Sim3<double>> {
  static std::vector<Field> fields() {
    return detail::joined(ValueFields<SE3<double>>::fields(), {{"scale", "", "positive"}});
  }
  static void read(FieldReader& reader, Sim3<double>& value) {
    SE3<double> pose;
    ValueFields<SE3<double>>::read(reader, pose);
    const double scale = reader.real();
    if (!(scale > 0.0) || !std::isfinite(scale)) reader.fail("the scale of a similarity must be positive");
    value = Sim3<double>(pose.rotation(), pose.translation(), scale);
  }
  static void write(const Sim3<double>& value, FieldWriter& writer) {
    ValueFields<SE3<double>>::write(SE3<double>(value.rotation(), value.translation()), writer);
    writer.real(value.scale());
  }
};

}  // namespace quiver
