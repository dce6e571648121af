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
struct ValueFields<Eigen::Matrix<double, R, C, Options>> {
  using Value = Eigen::Matrix<double, R, C, Options>;
  static_assert(R > 0 && C > 0, "a value of run-time size needs `read` and `write`");
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

/// x y z qx qy qz qw, Hamilton. Normalised only if | |q|² − 1 | > 1e-14; its sign is kept.
template <>
struct ValueFields<SE3<double>> {
  static std::vector<Field> fields() {
    return {{"x", "m", ""}, {"y", "m", ""}, {"z", "m", ""}, {"qx", "", "unit quaternion, Hamilton"},
            {"qy", "", ""}, {"qz", "", ""}, {"qw", "", ""}};
  }
  static void read(FieldReader& reader, SE3<double>& value) {
    std::array<double, 7> v;
    reader.reals(v);
    const double square = v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6];
    if (!(square > 1e-12) || !std::isfinite(square)) reader.fail("a quaternion of norm zero is no rotation");
    value = SE3<double>(SO3<double>(v[3], v[4], v[5], v[6]), Vector<double, 3>(v[0], v[1], v[2]));
  }
  static void write(const SE3<double>& value, FieldWriter& writer) {
    const Vector<double, 3> t = value.translation();
    const Vector<double, 4> q = value.rotation().coefficients();
    for (int i = 0; i < 3; ++i) writer.real(t[i]);
    for (int i = 0; i < 4; ++i) writer.real(q[i]);
  }
};

}  // namespace quiver
