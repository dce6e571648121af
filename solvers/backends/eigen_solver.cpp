#include <quiver/solvers/backends/eigen_solver.h>

#include <limits>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>

#include <quiver/core/util/error.h>
#include <quiver/solvers/backends/scalar_columns.h>
#include <quiver/solvers/backends/validate.h>
#include <quiver/solvers/block/factor_pattern.h>

namespace quiver {
namespace {

class EigenSolver final : public LinearSolver {
 public:
  std::string name() const override { return "eigen"; }
  BlockOrdering order(const BlockPattern& pattern) const override { return chooseOrdering(pattern); }

  void analyze(std::shared_ptr<const BlockPattern> pattern, int) override {
    pattern_ = std::move(pattern);
    columns_ = detail::ScalarColumns(*pattern_, detail::ScalarColumns::Triangle::upper);
    matrix_.resize(columns_.size(), columns_.size());
    matrix_.resizeNonZeros(static_cast<Eigen::Index>(columns_.rows().size()));
    std::copy(columns_.columns().begin(), columns_.columns().end(), matrix_.outerIndexPtr());
    std::copy(columns_.rows().begin(), columns_.rows().end(), matrix_.innerIndexPtr());
    const FactorSize size = predictFactor(*pattern_, naturalOrdering(pattern_->blocks()).order);
    if (size.nonzeros > std::numeric_limits<int>::max()) {
      throw LogicError(fmt::format("a factor of {} scalars is too large for a solver with 32-bit indices; try block",
                                   size.nonzeros));
    }
    factor_.analyzePattern(matrix_);
    statistics_ = {size.nonzeros, size.flops, 12 * (size.nonzeros + matrix_.nonZeros()), 0};
    factored_ = false;
  }

  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop) override {
    detail::validateFactorize(name(), pattern_.get(), matrix, damping);
    factored_ = false;
    if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
    columns_.load(matrix, damping, matrix_.valuePtr());
    factor_.factorize(matrix_);
    const auto& pivots = factor_.vectorD();
    for (Eigen::Index i = 0; i < pivots.size(); ++i) {
      if (pivots[i] > 0.0) continue;
      const auto [block, coordinate] = detail::ScalarColumns::locate(pattern_->layout(), i);
      return {SolverStatus::Outcome::notPositiveDefinite, block, coordinate, pivots[i]};
    }
    factored_ = true;
    return {};
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    detail::validateSolve(name(), factored_, pattern_.get(), rightHandSides, count);
    for (int k = 0; k < count; ++k) {
      Eigen::Map<Eigen::VectorXd> x(rightHandSides.data() + k * matrix_.rows(), matrix_.rows());
      factor_.matrixL().solveInPlace(x);
      x.array() /= factor_.vectorD().array();
      factor_.matrixU().solveInPlace(x);
    }
    return {};
  }

  FactorStatistics statistics() const override { return statistics_; }

 private:
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  std::shared_ptr<const BlockPattern> pattern_;
  detail::ScalarColumns columns_;
  Matrix matrix_;
  Eigen::SimplicialLDLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<int>> factor_;
  FactorStatistics statistics_;
  bool factored_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> makeEigenSolver() { return std::make_unique<EigenSolver>(); }

}  // namespace quiver
