#include "conjugate_gradient.h"

#include <vector>

#include <Eigen/Core>

namespace {

using Eigen::VectorXd;
using quiver::SolverStatus;

class ConjugateGradient final : public quiver::LinearSolver {
 public:
  std::string name() const override { return "conjugate_gradient"; }

  void analyze(std::shared_ptr<const quiver::BlockPattern> pattern, int) override {
    matrix_ = quiver::BlockMatrix(pattern);
    damping_ = VectorXd::Zero(pattern->layout().scalars());
    scale_ = damping_;
  }

  SolverStatus factorize(const quiver::BlockMatrix& matrix, std::span<const double> damping,
                         const quiver::StopCondition&) override {
    std::copy(matrix.values().begin(), matrix.values().end(), matrix_.values().begin());
    damping_.setZero();
    std::copy(damping.begin(), damping.end(), damping_.data());
    matrix_.diagonal({scale_.data(), static_cast<std::size_t>(scale_.size())});
    scale_ += damping_;
    if (scale_.minCoeff() <= 0.0) return {.outcome = SolverStatus::Outcome::notPositiveDefinite};
    scale_ = scale_.cwiseInverse();
    return {};
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    for (int k = 0; k < count; ++k) {
      Eigen::Map<VectorXd> b(rightHandSides.data() + k * scale_.size(), scale_.size());
      b = solution(b);
    }
    return {};
  }

  quiver::FactorStatistics statistics() const override { return {.iterations = iterations_}; }

 private:
  VectorXd times(const VectorXd& x) const {
    VectorXd y(x.size());
    const auto n = static_cast<std::size_t>(x.size());
    matrix_.multiply({x.data(), n}, {y.data(), n});
    return y + damping_.cwiseProduct(x);
  }

  VectorXd solution(const VectorXd& b) {
    VectorXd x = VectorXd::Zero(b.size());
    VectorXd residual = b;
    VectorXd direction = scale_.cwiseProduct(residual);
    double energy = residual.dot(direction);
    const double enough = 1e-28 * energy;
    for (iterations_ = 0; iterations_ < 10 * b.size() && energy > enough; ++iterations_) {
      const VectorXd image = times(direction);
      const double step = energy / direction.dot(image);
      x += step * direction;
      residual -= step * image;
      const VectorXd next = scale_.cwiseProduct(residual);
      const double before = energy;
      energy = residual.dot(next);
      direction = next + energy / before * direction;
    }
    return x;
  }

  quiver::BlockMatrix matrix_;
  VectorXd damping_;
  VectorXd scale_;
  int iterations_ = 0;
};

}  // namespace

std::unique_ptr<quiver::LinearSolver> makeConjugateGradient() { return std::make_unique<ConjugateGradient>(); }
