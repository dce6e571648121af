#pragma once

#include <array>

#include <quiver/core/graph/vertex.h>
#include <quiver/core/registry/element_types.h>
#include <quiver/geometry/sim3.h>
#include <quiver/types_sba/stereo_camera.h>

namespace quiver {

/// A similarity between two cameras' frames with the intrinsics fx, fy, cx, cy [px] of both.
template <class S>
struct CameraSimilarity {
  using Scalar = S;
  Sim3<S> similarity;
  S intrinsics[8];

  CameraSimilarity() {
    for (int i = 0; i < 8; ++i) intrinsics[i] = S(i % 4 < 2 ? 1.0 : 0.0);
  }

  Vector<S, 3> translation() const { return similarity.translation(); }
  /// 0 is the camera of p = G⁻¹ l, 1 that of p = G l.
  detail::StereoCamera<S> camera(int which) const {
    const S* k = intrinsics + 4 * which;
    return {k[0], k[1], k[2], k[3], S(0.0)};
  }
};

/// The similarity, then the intrinsics.
template <>
struct Packing<CameraSimilarity<double>> {
  static constexpr int size = 16, coordinates = 15, dimension = 7;
  template <class S>
  using Rebind = CameraSimilarity<S>;
  template <class S>
  static void store(const CameraSimilarity<S>& m, S* out) {
    Packing<Sim3<double>>::store(m.similarity, out);
    QUIVER_UNROLL for (int i = 0; i < 8; ++i) out[8 + i] = m.intrinsics[i];
  }
  template <class S>
  static CameraSimilarity<S> load(const S* in) {
    CameraSimilarity<S> m;
    m.similarity = Packing<Sim3<double>>::load(in);
    QUIVER_UNROLL for (int i = 0; i < 8; ++i) m.intrinsics[i] = in[8 + i];
    return m;
  }
};

namespace detail {

/// Files hold the logarithm with the rotation first.
inline Vector<double, 7> rotationFirst(const Vector<double, 7>& v) {
  Vector<double, 7> result;
  result << v[3], v[4], v[5], v[0], v[1], v[2], v[6];
  return result;
}
inline Sim3<double> similarityOf(const std::array<double, 7>& line) {
  Vector<double, 7> v;
  v << line[3], line[4], line[5], line[0], line[1], line[2], line[6];
  return Sim3<double>::exp(v);
}
/// Reads ln(G), which may not be so large that its scale is no number.
inline std::array<double, 7> readSimilarity(FieldReader& reader) {
  std::array<double, 7> line;
  reader.reals(line);
  const Sim3<double> similarity = similarityOf(line);
  if (!similarity.toVector().allFinite() || !(similarity.scale() > 0.0))
    reader.fail("the logarithm of the scale is out of bounds");
  return line;
}
/// Writes `line` if it stands for the similarity, else its logarithm.
inline void writeSimilarity(const Sim3<double>& similarity, const std::array<double, 7>& line, FieldWriter& writer) {
  if (similarityOf(line).toVector() == similarity.toVector()) return writer.reals(line);
  const Vector<double, 7> v = rotationFirst(similarity.log());
  writer.reals({v.data(), 7});
}
inline std::vector<Field> similarityFields() {
  return {{"wx", "rad", "logarithm, rotation first"},
          {"wy", "rad", ""},
          {"wz", "rad", ""},
          {"x", "m", ""},
          {"y", "m", ""},
          {"z", "m", ""},
          {"log_scale", "", ""}};
}

}  // namespace detail

/// A similarity G, camera to world, and the intrinsics of two cameras (g2o's VERTEX_SIM3:EXPMAP, which keeps the
/// inverse in memory and this in files, and does not write the second camera; where it is missing it is as the first).
/// Tangent: δ with G Exp(δ), δ = (ρ, φ, σ). A logarithm that was read is written again as it was while G is unchanged.
/// To keep the scale, hold direction 6.
class VertexSim3Expmap : public BaseVertex<VertexSim3Expmap, 7, CameraSimilarity<double>> {
 public:
  static constexpr std::array tangent{"x [m]",       "y [m]",     "z [m]",       "roll [rad]",
                                      "pitch [rad]", "yaw [rad]", "log scale []"};

  template <typename S>
  static CameraSimilarity<S> oplus(const CameraSimilarity<S>& x, const Vector<S, 7>& delta) {
    CameraSimilarity<S> moved = x;
    moved.similarity = x.similarity.retract(delta);
    return moved;
  }
  /// The scale moves the points, not the centre.
  static SE3<double> place(const CameraSimilarity<double>& x) {
    return {x.similarity.rotation(), x.similarity.translation()};
  }
  /// A motion Exp(ξ) of the world is Ad(G⁻¹) ξ; the world's directions are in the tangent's order.
  static Matrix<double, 7, gaugeDirections> gaugeGenerators(const CameraSimilarity<double>& x) {
    static_assert(gaugeX == 0 && gaugeRoll == 3 && gaugeScale == 6);
    return x.similarity.inverse().adjoint();
  }

  static std::vector<Field> fields() {
    std::vector<Field> fields = detail::similarityFields();
    for (const char* name : {"fx", "fy", "cx", "cy"}) fields.push_back({name, "px", ""});
    for (const char* name : {"fx2", "fy2", "cx2", "cy2"})
      fields.push_back({name, "px", "second camera; as the first where g2o leaves it out"});
    return fields;
  }
  void read(FieldReader& reader) {
    CameraSimilarity<double> camera;
    line_ = detail::readSimilarity(reader);
    camera.similarity = detail::similarityOf(line_);
    double* k = camera.intrinsics;
    reader.reals({k, 4});
    std::copy_n(k, 4, k + 4);
    if (!reader.atEnd()) reader.reals({k + 4, 4});
    setEstimate(camera);
  }
  void write(FieldWriter& writer) const {
    detail::writeSimilarity(estimate().similarity, line_, writer);
    writer.reals({values() + 8, 8});
  }

 private:
  /// The logarithm as read last.
  std::array<double, 7> line_{};
};

}  // namespace quiver
