#pragma once

#include <array>
#include <cmath>
#include <span>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/camera_snavely.h>
#include <quiver/types_slam3d/quaternion_error.h>

namespace quiver {

/// A camera of the "bundle adjustment in the large" data sets: a point X of the world is seen at p = R X + t, which
/// CameraSnavely projects with the intrinsics (f, k1, k2). R is a matrix, since projecting a point needs it as one.
template <class S>
struct BalCamera {
  using Scalar = S;
  /// World to camera.
  Matrix<S, 3, 3> rotation;
  Vector<S, 3> translation;
  Vector<S, 3> intrinsics;

  BalCamera()
      : rotation(Matrix<S, 3, 3>::Identity()),
        translation(S(0.0), S(0.0), S(0.0)),
        intrinsics(S(1.0), S(0.0), S(0.0)) {}
  BalCamera(const Matrix<S, 3, 3>& R, const Vector<S, 3>& t, const Vector<S, 3>& k)
      : rotation(R), translation(t), intrinsics(k) {}

  /// R X.
  Vector<S, 3> turned(const Vector<S, 3>& X) const {
    const Matrix<S, 3, 3>& R = rotation;
    return Vector<S, 3>(R(0, 0) * X[0] + R(0, 1) * X[1] + R(0, 2) * X[2],
                        R(1, 0) * X[0] + R(1, 1) * X[1] + R(1, 2) * X[2],
                        R(2, 0) * X[0] + R(2, 1) * X[1] + R(2, 2) * X[2]);
  }
  /// R X + t.
  Vector<S, 3> seen(const Vector<S, 3>& X) const {
    const Vector<S, 3> q = turned(X);
    return Vector<S, 3>(q[0] + translation[0], q[1] + translation[1], q[2] + translation[2]);
  }
};

/// The rotation by columns, the translation, f, k1, k2.
template <>
struct Packing<BalCamera<double>> {
  static constexpr int size = 15, coordinates = 9, dimension = 9;
  template <class S>
  using Rebind = BalCamera<S>;
  template <class S>
  static void store(const BalCamera<S>& m, S* out) {
    Packing<Matrix<double, 3, 3>>::store(m.rotation, out);
    Packing<Vector<double, 3>>::store(m.translation, out + 9);
    Packing<Vector<double, 3>>::store(m.intrinsics, out + 12);
  }
  template <class S>
  static BalCamera<S> load(const S* in) {
    BalCamera<S> camera;
    QUIVER_UNROLL for (int k = 0; k < 9; ++k) camera.rotation.data()[k] = in[k];
    QUIVER_UNROLL for (int k = 0; k < 3; ++k) {
      camera.translation.data()[k] = in[9 + k];
      camera.intrinsics.data()[k] = in[12 + k];
    }
    return camera;
  }
};

/// A camera of the "bundle adjustment in the large" files, whose nine numbers it reads: the rotation vector of R [rad],
/// t, f [px], k1, k2. Tangent: φ with Exp(φ) R [rad], then differences of t, f, k1 and k2. A rotation vector that was
/// read is written again as it was while the rotation is unchanged.
class VertexCameraBal : public BaseVertex<VertexCameraBal, 9, BalCamera<double>> {
 public:
  static constexpr std::array tangent{"roll [rad]", "pitch [rad]", "yaw [rad]", "x [m]", "y [m]",
                                      "z [m]",      "f [px]",      "k1 []",     "k2 []"};

  /// R ← Exp(φ) R, kept orthogonal by a Newton step R (3 I − RᵀR) / 2; the rest is added.
  template <typename S>
  static BalCamera<S> oplus(const BalCamera<S>& x, const Vector<S, 9>& delta) {
    const Matrix<S, 3, 3> turn = SO3<S>::exp(Vector<S, 3>(delta[0], delta[1], delta[2])).matrix();
    const Matrix<S, 3, 3> R = detail::product3<S>(turn, x.rotation);
    Matrix<S, 3, 3> correction = detail::product3<S>(detail::transposed<S>(R), R);
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) correction(r, c) = (r == c ? S(1.5) : S(0.0)) - 0.5 * correction(r, c);
    }
    return BalCamera<S>(
        detail::product3<S>(R, correction),
        Vector<S, 3>(x.translation[0] + delta[3], x.translation[1] + delta[4], x.translation[2] + delta[5]),
        Vector<S, 3>(x.intrinsics[0] + delta[6], x.intrinsics[1] + delta[7], x.intrinsics[2] + delta[8]));
  }

  /// The inverse of X ↦ R X + t, world to camera: the centre is −Rᵀ t.
  static SE3<double> place(const BalCamera<double>& x) {
    const Matrix<double, 3, 3> toWorld = x.rotation.transpose();
    return {SO3<double>::fromMatrix(toWorld), Vector<double, 3>(-(toWorld * x.translation))};
  }

  /// The world moved by τ: t' = t − R τ; turned by ω: R' = R Exp(−ω); scaled: t along itself.
  static Matrix<double, 9, gaugeDirections> gaugeGenerators(const BalCamera<double>& x) {
    Matrix<double, 9, gaugeDirections> G = Matrix<double, 9, gaugeDirections>::Zero();
    G.block<3, 3>(3, gaugeX) = -x.rotation;
    G.block<3, 3>(0, gaugeRoll) = -x.rotation;
    G.block<3, 1>(3, gaugeScale) = x.translation;
    return G;
  }

  static std::vector<Field> fields() {
    return {{"wx", "rad", "rotation vector, world to camera"},
            {"wy", "rad", ""},
            {"wz", "rad", ""},
            {"x", "m", "of p = R X + t"},
            {"y", "m", ""},
            {"z", "m", ""},
            {"f", "px", ""},
            {"k1", "", ""},
            {"k2", "", ""}};
  }
  void read(FieldReader& reader) {
    std::array<double, 9> numbers;
    const std::span all(numbers);
    reader.reals(all.first<3>());
    // The square of its length may overflow.
    if (!rotationOf({numbers[0], numbers[1], numbers[2]}).allFinite()) reader.fail("this rotation vector is too long");
    reader.reals(all.subspan<3>());
    setNumbers(numbers);
  }
  void write(FieldWriter& writer) const { writer.reals(numbers()); }

  /// The nine numbers of the file.
  std::array<double, 9> numbers() const {
    std::array<double, 9> result;
    const BalCamera<double> camera = estimate();
    Vector<double, 3> turn(turn_[0], turn_[1], turn_[2]);
    if (rotationOf(turn) != camera.rotation) turn = SO3<double>::fromMatrix(camera.rotation).log();
    for (std::size_t i = 0; i < 3; ++i) {
      result[i] = turn[static_cast<int>(i)];
      result[i + 3] = camera.translation[static_cast<int>(i)];
      result[i + 6] = camera.intrinsics[static_cast<int>(i)];
    }
    return result;
  }
  void setNumbers(const std::array<double, 9>& n) {
    turn_ = {n[0], n[1], n[2]};
    setEstimate(BalCamera<double>(rotationOf({n[0], n[1], n[2]}), {n[3], n[4], n[5]}, {n[6], n[7], n[8]}));
  }

 private:
  static Matrix<double, 3, 3> rotationOf(const Vector<double, 3>& turn) { return SO3<double>::exp(turn).matrix(); }
  /// The rotation vector as read last.
  std::array<double, 3> turn_{};
};

}  // namespace quiver
