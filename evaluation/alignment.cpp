#include <quiver/evaluation/alignment.h>

#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>
#include <Eigen/SVD>

#include <quiver/core/util/error.h>

namespace quiver {
namespace {

using Vector3 = Vector<double, 3>;
using Matrix3 = Matrix<double, 3, 3>;

/// Below this share of the largest one a singular value is rounding.
constexpr double negligible = 1e-12;

struct Moments {
  Vector3 fromMean = Vector3::Zero();
  Vector3 toMean = Vector3::Zero();
  /// Mean of (to − mean)(from − mean)ᵀ.
  Matrix3 covariance = Matrix3::Zero();
  /// Mean of ‖from − mean‖².
  double fromVariance = 0.0;
  double toVariance = 0.0;
};

Moments momentsOf(std::span<const Vector3> from, std::span<const Vector3> to) {
  const double n = static_cast<double>(from.size());
  Moments m;
  for (std::size_t i = 0; i < from.size(); ++i) {
    m.fromMean += from[i] / n;
    m.toMean += to[i] / n;
  }
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vector3 x = from[i] - m.fromMean;
    const Vector3 y = to[i] - m.toMean;
    m.covariance += y * x.transpose() / n;
    m.fromVariance += x.squaredNorm() / n;
    m.toVariance += y.squaredNorm() / n;
  }
  return m;
}

Alignment alignInPlane(const Moments& m) {
  // Rotating x by θ makes Σ y·Rx = c cos θ + s sin θ.
  const double c = m.covariance(0, 0) + m.covariance(1, 1);
  const double s = m.covariance(1, 0) - m.covariance(0, 1);
  Alignment alignment;
  const double size = std::hypot(c, s);
  alignment.unique = size > negligible * std::sqrt(m.fromVariance * m.toVariance);
  if (alignment.unique) {
    alignment.rotation(0, 0) = alignment.rotation(1, 1) = c / size;
    alignment.rotation(1, 0) = s / size;
    alignment.rotation(0, 1) = -s / size;
  }
  alignment.translation = m.toMean - alignment.rotation * m.fromMean;
  alignment.translation[2] = 0.0;
  return alignment;
}

Alignment alignInSpace(const Moments& m, bool scaled) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 signs = Vector3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs[2] = -1.0;
  Alignment alignment;
  alignment.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  const Vector3 d = svd.singularValues();
  // The rotation is unique if d2 + sign d3 > 0: Umeyama's rank condition, and no mirror image as good.
  alignment.unique = d[1] + signs[2] * d[2] > negligible * d[0] && d[0] > 0.0;
  if (scaled && m.fromVariance > 0.0) alignment.scale = d.dot(signs) / m.fromVariance;
  alignment.translation = m.toMean - alignment.scale * (alignment.rotation * m.fromMean);
  return alignment;
}

}  // namespace

Alignment alignPoints(std::span<const Vector3> from, std::span<const Vector3> to, AlignmentGroup group) {
  if (from.size() != to.size() || from.empty())
    throw GraphError(fmt::format("{} points cannot be aligned with {}", from.size(), to.size()));
  if (group == AlignmentGroup::none) return {};
  const Moments moments = momentsOf(from, to);
  if (group == AlignmentGroup::se2) return alignInPlane(moments);
  return alignInSpace(moments, group == AlignmentGroup::sim3);
}

std::string_view nameOf(AlignmentGroup group) {
  constexpr std::string_view names[] = {"none", "se2", "se3", "sim3"};
  return names[static_cast<int>(group)];
}

}  // namespace quiver
