#include "heap_graph.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace quiver::bench {
namespace {

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return m;
}

/// What both types share: D columns a vertex and as many errors.
template <int D>
class TypedHeapEdge : public HeapEdge {
 public:
  using Square = Eigen::Matrix<double, D, D>;
  using Error = Eigen::Matrix<double, D, 1>;

  TypedHeapEdge(HeapVertex& from, HeapVertex& to, const Square& information, double* block)
      : from_(from), to_(to), information_(information), block_(block) {}

  void addToHessian() override {
    const Square weighted0 = J0_.transpose() * information_;
    const Square weighted1 = J1_.transpose() * information_;
    Eigen::Map<Square>(from_.diagonal.data()).noalias() += weighted0 * J0_;
    Eigen::Map<Square>(to_.diagonal.data()).noalias() += weighted1 * J1_;
    Eigen::Map<Square>(block_).noalias() += weighted0 * J1_;
    Eigen::Map<Error>(from_.gradient.data()).noalias() += weighted0 * error_;
    Eigen::Map<Error>(to_.gradient.data()).noalias() += weighted1 * error_;
  }
  double chi2() const override { return error_.dot(information_ * error_); }

 protected:
  HeapVertex& from_;
  HeapVertex& to_;
  Square information_;
  double* block_;
  Error error_;
  Square J0_ = Square::Zero();
  Square J1_ = Square::Zero();
};

class PlanarEdge final : public TypedHeapEdge<3> {
 public:
  PlanarEdge(HeapVertex& from, HeapVertex& to, const Eigen::Vector3d& z, const Square& information, double* block)
      : TypedHeapEdge(from, to, information, block), z_(z), toMeasured_(Eigen::Rotation2Dd(-z[2])) {}

  void computeError() override {
    const Eigen::Vector2d d = to_.planar.head<2>() - from_.planar.head<2>();
    error_.head<2>() = toMeasured_ * (Eigen::Rotation2Dd(-from_.planar[2]) * d - z_.head<2>());
    error_[2] = std::remainder(to_.planar[2] - from_.planar[2] - z_[2], 2.0 * std::numbers::pi);
  }
  void linearizeOplus() override {
    const Eigen::Vector2d d = to_.planar.head<2>() - from_.planar.head<2>();
    const Eigen::Vector2d p = Eigen::Rotation2Dd(-from_.planar[2]) * d;
    J0_.topLeftCorner<2, 2>() = -toMeasured_;
    J0_.topRightCorner<2, 1>() = toMeasured_ * Eigen::Vector2d(p[1], -p[0]);
    J0_(2, 2) = -1.0;
    J1_.topLeftCorner<2, 2>() = toMeasured_ * Eigen::Rotation2Dd(to_.planar[2] - from_.planar[2]).toRotationMatrix();
    J1_(2, 2) = 1.0;
  }

 private:
  Eigen::Vector3d z_;
  Eigen::Matrix2d toMeasured_;
};

class SpatialEdge final : public TypedHeapEdge<6> {
 public:
  SpatialEdge(HeapVertex& from, HeapVertex& to, const Eigen::Isometry3d& z, const Square& information, double* block)
      : TypedHeapEdge(from, to, information, block), inverse_(z.inverse(Eigen::Isometry)) {}

  void computeError() override {
    relative_ = from_.pose.inverse(Eigen::Isometry) * to_.pose;
    off_ = inverse_ * relative_;
    quaternion_ = Eigen::Quaterniond(off_.linear());
    if (quaternion_.w() < 0.0) quaternion_.coeffs() *= -1.0;
    error_.head<3>() = off_.translation();
    error_.tail<3>() = quaternion_.vec();
  }
  void linearizeOplus() override {
    const Eigen::Matrix3d R = inverse_.linear();
    const Eigen::Matrix3d w = quaternion_.w() * Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d v = cross(quaternion_.vec());
    J0_.topLeftCorner<3, 3>() = -R;
    J0_.topRightCorner<3, 3>() = R * cross(relative_.translation());
    J0_.bottomRightCorner<3, 3>() = -0.5 * (w - v) * R;
    J1_.topLeftCorner<3, 3>() = off_.linear();
    J1_.bottomRightCorner<3, 3>() = 0.5 * (w + v);
  }

 private:
  Eigen::Isometry3d inverse_;
  Eigen::Isometry3d relative_;
  Eigen::Isometry3d off_;
  Eigen::Quaterniond quaternion_;
};

}  // namespace

HeapVertex& HeapGraph::addVertex(int dimension) {
  vertices_.push_back(std::make_unique<HeapVertex>());
  vertices_.back()->diagonal.resize(static_cast<std::size_t>(dimension * dimension));
  vertices_.back()->gradient.resize(static_cast<std::size_t>(dimension));
  return *vertices_.back();
}

void HeapGraph::addPlanarEdge(HeapVertex& from, HeapVertex& to, const Eigen::Vector3d& z,
                              const Eigen::Matrix3d& information) {
  offDiagonal_.push_back(std::make_unique<double[]>(9));
  edges_.push_back(std::make_unique<PlanarEdge>(from, to, z, information, offDiagonal_.back().get()));
}

void HeapGraph::addSpatialEdge(HeapVertex& from, HeapVertex& to, const Eigen::Isometry3d& z,
                               const Eigen::Matrix<double, 6, 6>& information) {
  offDiagonal_.push_back(std::make_unique<double[]>(36));
  edges_.push_back(std::make_unique<SpatialEdge>(from, to, z, information, offDiagonal_.back().get()));
}

double HeapGraph::linearize() {
  for (const auto& vertex : vertices_) {
    std::fill(vertex->diagonal.begin(), vertex->diagonal.end(), 0.0);
    std::fill(vertex->gradient.begin(), vertex->gradient.end(), 0.0);
  }
  const std::size_t blockSize = vertices_.empty() ? 0 : vertices_.front()->diagonal.size();
  for (const auto& block : offDiagonal_) std::fill_n(block.get(), blockSize, 0.0);
  double sum = 0.0;
  for (const auto& edge : edges_) {
    edge->computeError();
    edge->linearizeOplus();
    edge->addToHessian();
    sum += edge->chi2();
  }
  return sum;
}

double HeapGraph::gradientSquare() const {
  double sum = 0.0;
  for (const auto& vertex : vertices_) {
    for (const double value : vertex->gradient) sum += value * value;
  }
  return sum;
}

}  // namespace quiver::bench
