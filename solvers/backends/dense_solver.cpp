#include <quiver/solvers/backends/dense_solver.h>

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <quiver/solvers/backends/scalar_columns.h>
#include <quiver/solvers/backends/validate.h>

namespace quiver {
namespace {

constexpr Eigen::Index panelWidth = 48;

/// Factors the lower triangle of a in place; returns the first column whose pivot (stored in `pivot`) is not positive,
/// or −1.
Eigen::Index factorInPlace(Eigen::Ref<Eigen::MatrixXd> a, double& pivot) {
  for (Eigen::Index c = 0; c < a.cols(); ++c) {
    pivot = a(c, c);
    if (!(pivot > 0.0)) return c;
    const Eigen::Index below = a.rows() - c - 1;
    a(c, c) = std::sqrt(pivot);
    a.col(c).tail(below) /= a(c, c);
    for (Eigen::Index k = c + 1; k < a.cols(); ++k)
      a.col(k).tail(a.rows() - k) -= a(k, c) * a.col(c).tail(a.rows() - k);
  }
  return -1;
}

class DenseSolver final : public LinearSolver {
 public:
  std::string name() const override { return "dense"; }

  void analyze(std::shared_ptr<const BlockPattern> pattern, int) override {
    pattern_ = std::move(pattern);
    const Eigen::Index n = pattern_->layout().scalars();
    factor_.resize(n, n);
    factored_ = false;
  }

  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop) override {
    detail::validateFactorize(name(), pattern_.get(), matrix, damping);
    factored_ = false;
    load(matrix, damping);
    const Eigen::Index n = factor_.rows();
    for (Eigen::Index c = 0; c < n; c += panelWidth) {
      if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
      const Eigen::Index width = std::min(panelWidth, n - c);
      double pivot = 0.0;
      const Eigen::Index failed = factorInPlace(factor_.block(c, c, width, width), pivot);
      if (failed >= 0) {
        const auto [block, coordinate] = detail::ScalarColumns::locate(pattern_->layout(), c + failed);
        return {SolverStatus::Outcome::notPositiveDefinite, block, coordinate, pivot};
      }
      const Eigen::Index below = n - c - width;
      auto panel = factor_.block(c + width, c, below, width);
      factor_.block(c, c, width, width)
          .triangularView<Eigen::Lower>()
          .transpose()
          .solveInPlace<Eigen::OnTheRight>(panel);
      factor_.bottomRightCorner(below, below).selfadjointView<Eigen::Lower>().rankUpdate(panel, -1.0);
    }
    factored_ = true;
    return {};
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    detail::validateSolve(name(), factored_, pattern_.get(), rightHandSides, count);
    Eigen::Map<Eigen::MatrixXd> x(rightHandSides.data(), factor_.rows(), count);
    factor_.triangularView<Eigen::Lower>().solveInPlace(x);
    factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    return {};
  }

  FactorStatistics statistics() const override {
    const auto n = static_cast<double>(factor_.rows());
    return {factor_.rows() * (factor_.rows() + 1) / 2, n * (n + 1) * (2 * n + 1) / 6, factor_.size() * 8, 0};
  }

 private:
  void load(const BlockMatrix& matrix, std::span<const double> damping) {
    const BlockLayout& layout = pattern_->layout();
    factor_.setZero();
    for (int column = 0; column < layout.blocks(); ++column) {
      for (std::int64_t k = pattern_->columnBegin(column); k < pattern_->columnEnd(column); ++k) {
        const int row = pattern_->row(k);
        const int rows = layout.dimension(row);
        const int columns = layout.dimension(column);
        factor_.block(layout.offset(row), layout.offset(column), rows, columns) =
            Eigen::Map<const Eigen::MatrixXd>(matrix.block(k), rows, columns);
      }
    }
    for (std::size_t i = 0; i < damping.size(); ++i) {
      factor_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += damping[i];
    }
  }

  std::shared_ptr<const BlockPattern> pattern_;
  Eigen::MatrixXd factor_;
  bool factored_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> makeDenseSolver() { return std::make_unique<DenseSolver>(); }

}  // namespace quiver
