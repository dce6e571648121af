#pragma once

#include <array>

#include <quiver/core/registry/value_fields.h>
#include <quiver/types_sba/stereo_camera.h>
#include <quiver/types_slam3d/vertex_se3.h>

namespace quiver {

/// A pose with the intrinsics of the stereo camera there: fx, fy, cx, cy [px], baseline [m].
template <class S>
struct PosedCamera {
  using Scalar = S;
  /// Camera to world, z forward.
  SE3<S> pose;
  Vector<S, 5> intrinsics;

  PosedCamera() {
    const double usual[5] = {300.0, 300.0, 320.0, 320.0, 0.1};
    for (int i = 0; i < 5; ++i) intrinsics[i] = S(usual[i]);
  }
  PosedCamera(const SE3<S>& at, const Vector<S, 5>& k) : pose(at), intrinsics(k) {}

  Vector<S, 3> translation() const { return pose.translation(); }
  detail::StereoCamera<S> stereo() const {
    const Vector<S, 5>& k = intrinsics;
    return {k[0], k[1], k[2], k[3], k[0] * k[4]};
  }
};

/// The pose, then fx, fy, cx, cy, baseline.
template <>
struct Packing<PosedCamera<double>> {
  static constexpr int size = 12, coordinates = 12, dimension = 6;
  template <class S>
  using Rebind = PosedCamera<S>;
  template <class S>
  static void store(const PosedCamera<S>& m, S* out) {
    Packing<SE3<double>>::store(m.pose, out);
    Packing<Vector<double, 5>>::store(m.intrinsics, out + 7);
  }
  template <class S>
  static PosedCamera<S> load(const S* in) {
    return PosedCamera<S>(Packing<SE3<double>>::load(in), Packing<Vector<double, 5>>::load(in + 7));
  }
};

/// A camera's pose, camera to world, with constant intrinsics of its own (g2o's VERTEX_CAM). Tangent: that of
/// VertexSE3.
class VertexCam : public BaseVertex<VertexCam, 6, PosedCamera<double>> {
 public:
  static constexpr std::array tangent = VertexSE3::tangent;

  template <typename S>
  static PosedCamera<S> oplus(const PosedCamera<S>& x, const Vector<S, 6>& delta) {
    return PosedCamera<S>(x.pose.retract(delta), x.intrinsics);
  }
  static SE3<double> place(const PosedCamera<double>& x) { return x.pose; }
  static Matrix<double, 6, gaugeDirections> gaugeGenerators(const PosedCamera<double>& x) {
    return VertexSE3::gaugeGenerators(x.pose);
  }

  static std::vector<Field> fields() {
    std::vector<Field> fields = ValueFields<SE3<double>>::fields();
    for (const char* name : {"fx", "fy", "cx", "cy"})
      fields.push_back({name, "px", "may be left out with what follows: 300 300 320 320 0.1"});
    fields.push_back({"baseline", "m", ""});
    return fields;
  }
  void read(FieldReader& reader) {
    PosedCamera<double> camera;
    ValueFields<SE3<double>>::read(reader, camera.pose);
    if (!reader.atEnd()) reader.reals({camera.intrinsics.data(), 5});
    setEstimate(camera);
  }
  void write(FieldWriter& writer) const { writer.reals({values(), 12}); }
};

/// Intrinsics that are estimated and that any number of cameras may share: fx, fy, cx, cy [px]; the baseline [m] is
/// carried along (g2o's VERTEX_INTRINSICS).
class VertexIntrinsics : public BaseVertex<VertexIntrinsics, 4, Vector<double, 5>> {
 public:
  static constexpr std::array tangent{"fx [px]", "fy [px]", "cx [px]", "cy [px]"};

  template <typename S>
  static Vector<S, 5> oplus(const Vector<S, 5>& x, const Vector<S, 4>& delta) {
    Vector<S, 5> moved = x;
    QUIVER_UNROLL for (int i = 0; i < 4; ++i) moved[i] = x[i] + delta[i];
    return moved;
  }
  /// The world may move as it likes.
  static Matrix<double, 4, gaugeDirections> gaugeGenerators(const Vector<double, 5>&) {
    return Matrix<double, 4, gaugeDirections>::Zero();
  }
  static std::vector<Field> fields() {
    return {{"fx", "px", ""}, {"fy", "px", ""}, {"cx", "px", ""}, {"cy", "px", ""}, {"baseline", "m", "constant"}};
  }
};

}  // namespace quiver
