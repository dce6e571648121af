#include <quiver/solvers/backends/power_solver.h>

#include <algorithm>
#include <cmath>

#include <quiver/solvers/backends/pcg_solver.h>
#include <quiver/solvers/backends/validate.h>
#include <quiver/solvers/block/symmetric_product.h>

namespace quiver {
namespace {

double squaredNorm(std::span<const double> a) {
  double sum = 0.0;
  for (const double value : a) sum += value * value;
  return sum;
}

class PowerSolver final : public LinearSolver {
 public:
  PowerSolver(double tolerance, int terms) : tolerance_(tolerance), terms_(terms) {}

  std::string name() const override { return "power"; }

  void analyze(std::shared_ptr<const BlockPattern> pattern, int threads) override {
    pattern_ = std::move(pattern);
    diagonalPattern_ = std::make_shared<const BlockPattern>(BlockPattern::fromPairs(pattern_->layout(), {}));
    diagonal_ = BlockMatrix(diagonalPattern_);
    // On diagonal blocks alone the preconditioner of conjugate gradients is exact: one iteration.
    blocks_ = makePcgSolver({.tolerance = 1e-15, .maxIterations = 2, .forcing = false});
    blocks_->analyze(diagonalPattern_, threads);
    product_ = SymmetricProduct(*pattern_);
    const auto scalars = static_cast<std::size_t>(pattern_->layout().scalars());
    term_.assign(scalars, 0.0);
    image_.assign(scalars, 0.0);
    std::vector<int> counts(static_cast<std::size_t>(pattern_->blocks()), 0);
    for (int column = 0; column < pattern_->blocks(); ++column) {
      for (std::int64_t k = pattern_->columnBegin(column); k < pattern_->columnEnd(column); ++k) {
        ++counts[static_cast<std::size_t>(column)];
        if (pattern_->row(k) != column) ++counts[static_cast<std::size_t>(pattern_->row(k))];
      }
    }
    scale_ = counts.empty() ? 1.0 : *std::max_element(counts.begin(), counts.end());
    matrix_ = nullptr;
    iterations_ = 0;
  }

  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop) override {
    detail::validateFactorize(name(), pattern_.get(), matrix, damping);
    matrix_ = nullptr;
    stop_ = stop;
    damping_.assign(damping.begin(), damping.end());
    for (int block = 0; block < pattern_->blocks(); ++block) {
      const int n = pattern_->layout().dimension(block);
      std::copy_n(matrix.block(pattern_->columnBegin(block)), n * n,
                  diagonal_.block(diagonalPattern_->columnBegin(block)));
    }
    const SolverStatus status = blocks_->factorize(diagonal_, damping, stop);
    if (status.ok()) matrix_ = &matrix;
    return status;
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    detail::validateSolve(name(), matrix_ != nullptr, pattern_.get(), rightHandSides, count);
    const auto scalars = static_cast<std::size_t>(pattern_->layout().scalars());
    iterations_ = 0;
    for (int k = 0; k < count; ++k) {
      const SolverStatus status = sum(rightHandSides.subspan(static_cast<std::size_t>(k) * scalars, scalars));
      if (!status.ok()) return status;
    }
    return {};
  }

  FactorStatistics statistics() const override {
    FactorStatistics statistics = blocks_ ? blocks_->statistics() : FactorStatistics{};
    statistics.bytes += static_cast<std::int64_t>(3 * term_.size() + diagonal_.values().size()) * 8 + product_.bytes();
    statistics.iterations = iterations_;
    return statistics;
  }

 private:
  /// v ← M⁻¹ v.
  SolverStatus divide(std::span<double> v) {
    const SolverStatus status = blocks_->solve(v, 1);
    for (double& value : v) value /= scale_;
    return status.outcome == SolverStatus::Outcome::notConverged ? SolverStatus{} : status;
  }

  SolverStatus sum(std::span<double> x) {
    if (const SolverStatus status = divide(x); !status.ok()) return status;
    std::copy(x.begin(), x.end(), term_.begin());
    for (int i = 1; i <= terms_; ++i) {
      if (stop_.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
      product_.multiply(*matrix_, term_.data(), image_.data(), 0, pattern_->blocks());
      for (std::size_t k = 0; k < damping_.size(); ++k) image_[k] += damping_[k] * term_[k];
      if (const SolverStatus status = divide(image_); !status.ok()) return status;
      for (std::size_t k = 0; k < x.size(); ++k) {
        term_[k] -= image_[k];
        x[k] += term_[k];
      }
      ++iterations_;
      if (!(std::sqrt(squaredNorm(term_)) * i > tolerance_ * std::sqrt(squaredNorm(x)))) return {};
    }
    return {.outcome = SolverStatus::Outcome::notConverged};
  }

  double tolerance_;
  int terms_;
  std::shared_ptr<const BlockPattern> pattern_;
  std::shared_ptr<const BlockPattern> diagonalPattern_;
  BlockMatrix diagonal_;
  std::unique_ptr<LinearSolver> blocks_;
  SymmetricProduct product_;
  const BlockMatrix* matrix_ = nullptr;
  StopCondition stop_;
  std::vector<double> damping_;
  std::vector<double> term_;
  std::vector<double> image_;
  double scale_ = 1.0;
  int iterations_ = 0;
};

}  // namespace

std::unique_ptr<LinearSolver> makePowerSolver(double tolerance, int terms) {
  return std::make_unique<PowerSolver>(tolerance, terms);
}

}  // namespace quiver
