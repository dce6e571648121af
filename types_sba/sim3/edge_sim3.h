#pragma once

#include <quiver/core/graph/edge.h>
#include <quiver/types_sba/sim3/vertex_sim3_expmap.h>
#include <quiver/types_slam3d/vertex_xyz.h>

namespace quiver {

/// The similarity Z of the second camera seen from the first; e = (φ, ρ, σ), rotation first, of ln(Z⁻¹ G₁⁻¹ G₂) (g2o's
/// EDGE_SIM3:EXPMAP: ln(C S₁ S₂⁻¹) with S = G⁻¹ and C = Z⁻¹, which is what files hold the inverse's logarithm of).
class EdgeSim3Expmap : public BaseEdge<EdgeSim3Expmap, 7, Sim3<double>, VertexSim3Expmap, VertexSim3Expmap> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 7> computeError(const Sim3<S>& z, const CameraSimilarity<S>& first,
                                   const CameraSimilarity<S>& second) {
    const Vector<S, 7> v = z.between(first.similarity.between(second.similarity)).log();
    Vector<S, 7> e;
    QUIVER_UNROLL for (int i = 0; i < 3; ++i) {
      e[i] = v[i + 3];
      e[i + 3] = v[i];
    }
    e[6] = v[6];
    return e;
  }

  /// J_r⁻¹(e) by the second, −J_r⁻¹(e) Ad(G₂⁻¹ G₁) by the first.
  template <typename S>
  static void linearizeOplus(const Sim3<S>& z, const CameraSimilarity<S>& first, const CameraSimilarity<S>& second,
                             Matrix<S, 7, 7>& J0, Matrix<S, 7, 7>& J1) {
    const Sim3<S> E = first.similarity.between(second.similarity);
    const Matrix<S, 7, 7> J = Sim3<S>::rightJacobianInverse(z.between(E).log());
    const Matrix<S, 7, 7> Ad = E.inverse().adjoint();
    for (int r = 0; r < 7; ++r) {
      const int to = r == 6 ? 6 : (r + 3) % 6;
      for (int c = 0; c < 7; ++c) {
        S sum = J(r, 0) * Ad(0, c);
        for (int k = 1; k < 7; ++k) sum += J(r, k) * Ad(k, c);
        J0(to, c) = -sum;
        J1(to, c) = J(r, c);
      }
    }
  }

  static bool initialEstimate(int to, const Sim3<double>& z, CameraSimilarity<double>& first,
                              CameraSimilarity<double>& second) {
    if (to == 1) {
      second.similarity = first.similarity * z;
    } else {
      first.similarity = second.similarity * z.inverse();
    }
    return true;
  }

  static std::vector<Field> fields() { return detail::similarityFields(); }
  void read(FieldReader& reader) {
    line_ = detail::readSimilarity(reader);
    setMeasurement(detail::similarityOf(line_));
  }
  void write(FieldWriter& writer) const { detail::writeSimilarity(measurement(), line_, writer); }

 private:
  /// The logarithm as read last.
  std::array<double, 7> line_{};
};

/// A pixel of a point in the first camera: e = z − π₁(G⁻¹ l) (g2o's EDGE_PROJECT_SIM3_XYZ:EXPMAP).
class EdgeProjectSim3 : public BaseEdge<EdgeProjectSim3, 2, Vector<double, 2>, VertexXYZ, VertexSim3Expmap> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 3>& point, const CameraSimilarity<S>& G) {
    return detail::difference<S, 2>(z, G.camera(0).template project<2>(G.similarity.actInverse(point)));
  }
  /// With p = G⁻¹ l and N = ∂e/∂p: N [−I, [p]ₓ, −p] by G, N Rᵀ / s by the point.
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 3>& point, const CameraSimilarity<S>& G,
                             Matrix<S, 2, 3>& J0, Matrix<S, 2, 7>& J1) {
    const Vector<S, 3> p = G.similarity.actInverse(point);
    const Matrix<S, 2, 3> N = G.camera(0).template pointJacobian<2>(p, -1.0);
    const Matrix<S, 3, 3> R = G.similarity.rotation().matrix();
    const S inverse = 1.0 / G.similarity.scale();
    Matrix<S, 2, 6> byMotion;
    detail::seenPointByPose<S, 2>(N, p, byMotion);
    QUIVER_UNROLL for (int r = 0; r < 2; ++r) {
      QUIVER_UNROLL for (int c = 0; c < 6; ++c) J1(r, c) = byMotion(r, c);
      J1(r, 6) = -(N(r, 0) * p[0] + N(r, 1) * p[1] + N(r, 2) * p[2]);
      QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
        J0(r, c) = inverse * (N(r, 0) * R(c, 0) + N(r, 1) * R(c, 1) + N(r, 2) * R(c, 2));
      }
    }
  }
  static bool isDepthPositive(const Vector<double, 2>&, const Vector<double, 3>& point,
                              const CameraSimilarity<double>& G) {
    return G.similarity.actInverse(point)[2] > 0.0;
  }
  static std::vector<Field> fields() { return detail::pixelFields<2>(); }
};

/// A pixel of a point in the second camera: e = z − π₂(G l) (g2o's EDGE_PROJECT_INVERSE_SIM3_XYZ:EXPMAP).
class EdgeProjectInverseSim3
    : public BaseEdge<EdgeProjectInverseSim3, 2, Vector<double, 2>, VertexXYZ, VertexSim3Expmap> {
 public:
  static constexpr bool lanes = true;

  template <typename S>
  static Vector<S, 2> computeError(const Vector<S, 2>& z, const Vector<S, 3>& point, const CameraSimilarity<S>& G) {
    return detail::difference<S, 2>(z, G.camera(1).template project<2>(G.similarity * point));
  }
  /// With N = ∂e/∂p at p = G l and M = N s R: M [I, −[l]ₓ, l] by G, M by the point.
  template <typename S>
  static void linearizeOplus(const Vector<S, 2>&, const Vector<S, 3>& point, const CameraSimilarity<S>& G,
                             Matrix<S, 2, 3>& J0, Matrix<S, 2, 7>& J1) {
    const Matrix<S, 2, 3> N = G.camera(1).template pointJacobian<2>(G.similarity * point, 1.0);
    const Matrix<S, 3, 3> R = G.similarity.rotation().matrix();
    const S scale = -G.similarity.scale();
    Matrix<S, 2, 3> negative;
    QUIVER_UNROLL for (int r = 0; r < 2; ++r) {
      QUIVER_UNROLL for (int c = 0; c < 3; ++c) {
        J0(r, c) = scale * (N(r, 0) * R(0, c) + N(r, 1) * R(1, c) + N(r, 2) * R(2, c));
        negative(r, c) = -J0(r, c);
      }
    }
    Matrix<S, 2, 6> byMotion;
    detail::seenPointByPose<S, 2>(negative, point, byMotion);
    QUIVER_UNROLL for (int r = 0; r < 2; ++r) {
      QUIVER_UNROLL for (int c = 0; c < 6; ++c) J1(r, c) = byMotion(r, c);
      J1(r, 6) = J0(r, 0) * point[0] + J0(r, 1) * point[1] + J0(r, 2) * point[2];
    }
  }
  static bool isDepthPositive(const Vector<double, 2>&, const Vector<double, 3>& point,
                              const CameraSimilarity<double>& G) {
    return (G.similarity * point)[2] > 0.0;
  }
  static std::vector<Field> fields() { return detail::pixelFields<2>(); }
};

}  // namespace quiver
