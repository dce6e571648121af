#include "bundle_motion.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Cholesky>

namespace quiver::bench {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

class HeapKernel {
 public:
  virtual ~HeapKernel() = default;
  /// ρ and ρ' of a squared error.
  virtual void robustify(double square, double& rho, double& slope) const = 0;
};

class HeapHuber final : public HeapKernel {
 public:
  explicit HeapHuber(double width) : width_(width) {}
  void robustify(double square, double& rho, double& slope) const override {
    const double root = std::sqrt(square);
    const bool inside = root <= width_;
    rho = inside ? square : 2.0 * width_ * root - width_ * width_;
    slope = inside ? 1.0 : width_ / root;
  }

 private:
  double width_;
};

struct HeapPose {
  Eigen::Isometry3d estimate;
  Matrix6 hessian;
  Vector6 gradient;
};

class HeapPixel {
 public:
  virtual ~HeapPixel() = default;
  virtual void computeError() = 0;
  virtual void linearizeOplus() = 0;
  virtual double robustCost() const = 0;
  virtual void addToHessian() = 0;
};

class HeapPixelOnPose final : public HeapPixel {
 public:
  HeapPixelOnPose(HeapPose& pose, const KnownPoint& known, const Eigen::Vector4d& k, double huber)
      : pose_(pose),
        point_(known.point),
        pixel_(known.pixel),
        k_(k),
        information_(Eigen::Matrix2d::Identity()),
        kernel_(std::make_unique<HeapHuber>(huber)) {}

  void computeError() override {
    const Eigen::Vector3d p = pose_.estimate.inverse() * point_;
    error_ = Eigen::Vector2d(k_[0] * p[0] / p[2] + k_[2], k_[1] * p[1] / p[2] + k_[3]) - pixel_;
  }
  void linearizeOplus() override {
    const Eigen::Vector3d p = pose_.estimate.inverse() * point_;
    const double w = 1.0 / p[2];
    Eigen::Matrix<double, 2, 3> N;
    N << k_[0] * w, 0.0, -k_[0] * p[0] * w * w, 0.0, k_[1] * w, -k_[1] * p[1] * w * w;
    Eigen::Matrix3d hat;
    hat << 0.0, -p[2], p[1], p[2], 0.0, -p[0], -p[1], p[0], 0.0;
    jacobian_.leftCols<3>() = -N;
    jacobian_.rightCols<3>() = N * hat;
  }
  double robustCost() const override {
    double rho = 0.0, slope = 0.0;
    kernel_->robustify(error_.dot(information_ * error_), rho, slope);
    return rho;
  }
  void addToHessian() override {
    double rho = 0.0, slope = 0.0;
    kernel_->robustify(error_.dot(information_ * error_), rho, slope);
    const Eigen::Matrix<double, 6, 2> weighted = jacobian_.transpose() * (slope * information_);
    pose_.hessian += weighted * jacobian_;
    pose_.gradient += weighted * error_;
  }

 private:
  HeapPose& pose_;
  Eigen::Vector3d point_;
  Eigen::Vector2d pixel_;
  Eigen::Vector4d k_;
  Eigen::Matrix2d information_;
  std::unique_ptr<HeapKernel> kernel_;
  Eigen::Vector2d error_;
  Eigen::Matrix<double, 2, 6> jacobian_;
};

/// X Exp(ρ, φ) to first order in the translation.
Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Vector6& delta) {
  const Eigen::Vector3d phi = delta.tail<3>();
  const double angle = phi.norm();
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  if (angle > 1e-12) step.linear() = Eigen::AngleAxisd(angle, phi / angle).toRotationMatrix();
  step.translation() = delta.head<3>();
  return pose * step;
}

double evaluate(const std::vector<std::unique_ptr<HeapPixel>>& edges) {
  double cost = 0.0;
  for (const auto& edge : edges) {
    edge->computeError();
    cost += edge->robustCost();
  }
  return cost;
}

}  // namespace

HeapMotion moveCameraOnHeap(const Eigen::Isometry3d& start, const std::vector<KnownPoint>& points,
                            const Eigen::Vector4d& intrinsics, double huber, int iterations) {
  const auto pose = std::make_unique<HeapPose>();
  pose->estimate = start;
  std::vector<std::unique_ptr<HeapPixel>> edges;
  for (const KnownPoint& known : points)
    edges.push_back(std::make_unique<HeapPixelOnPose>(*pose, known, intrinsics, huber));

  double cost = evaluate(edges), damping = 1e-4;
  for (int i = 0; i < iterations; ++i) {
    pose->hessian.setZero();
    pose->gradient.setZero();
    for (const auto& edge : edges) {
      edge->linearizeOplus();
      edge->addToHessian();
    }
    Matrix6 damped = pose->hessian;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 delta = damped.ldlt().solve(-pose->gradient);
    const Eigen::Isometry3d before = pose->estimate;
    pose->estimate = moved(before, delta);
    const double trial = evaluate(edges);
    if (trial <= cost) {
      cost = trial;
      damping = std::max(1e-12, damping / 3.0);
    } else {
      pose->estimate = before;
      damping *= 4.0;
      evaluate(edges);
    }
  }
  return {pose->estimate, cost};
}

}  // namespace quiver::bench
