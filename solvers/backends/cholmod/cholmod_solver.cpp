#include <quiver/solvers/backends/cholmod/cholmod_solver.h>

#include <cholmod.h>
#include <dlfcn.h>

#include <algorithm>
#include <limits>

#include <quiver/core/util/error.h>
#include <quiver/solvers/backends/scalar_columns.h>
#include <quiver/solvers/backends/validate.h>
#include <quiver/solvers/block/factor_pattern.h>

namespace quiver {
namespace {

/// OpenBLAS runs small fronts slower on several threads than on one; other BLAS libraries do not have the function.
void limitBlasThreads() {
  using SetThreads = void (*)(int);
  if (void* symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<SetThreads>(symbol)(1);
}

class CholmodSolver final : public LinearSolver {
 public:
  CholmodSolver() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = 1;
    common_.supernodal = CHOLMOD_AUTO;
    common_.quick_return_if_not_posdef = 1;
    limitBlasThreads();
  }
  ~CholmodSolver() override {
    release();
    cholmod_finish(&common_);
  }
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  std::string name() const override { return "cholmod"; }
  BlockOrdering order(const BlockPattern& pattern) const override { return chooseOrdering(pattern); }

  void analyze(std::shared_ptr<const BlockPattern> pattern, int) override {
    release();
    pattern_ = std::move(pattern);
    columns_ = detail::ScalarColumns(*pattern_, detail::ScalarColumns::Triangle::lower);
    const auto n = static_cast<std::size_t>(columns_.size());
    matrix_ = cholmod_allocate_sparse(n, n, columns_.rows().size(), 1, 1, -1, CHOLMOD_REAL, &common_);
    if (matrix_ == nullptr) throw Error("cholmod: out of memory");
    std::copy(columns_.columns().begin(), columns_.columns().end(), static_cast<int*>(matrix_->p));
    std::copy(columns_.rows().begin(), columns_.rows().end(), static_cast<int*>(matrix_->i));
    factor_ = cholmod_analyze(matrix_, &common_);
    if (factor_ == nullptr) throw Error("cholmod: the analysis failed with status " + std::to_string(common_.status));
    const FactorSize size = predictFactor(*pattern_, naturalOrdering(pattern_->blocks()).order);
    statistics_ = {size.nonzeros, size.flops, static_cast<std::int64_t>(common_.memory_inuse), 0};
  }

  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop) override {
    detail::validateFactorize(name(), pattern_.get(), matrix, damping);
    factored_ = false;
    if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
    columns_.load(matrix, damping, static_cast<double*>(matrix_->x));
    cholmod_factorize(matrix_, factor_, &common_);
    statistics_.bytes = static_cast<std::int64_t>(common_.memory_inuse);
    if (common_.status == CHOLMOD_OUT_OF_MEMORY) return {.outcome = SolverStatus::Outcome::memoryLimit};
    if (factor_->minor < factor_->n) {
      const auto* permutation = static_cast<const int*>(factor_->Perm);
      const auto [block, coordinate] = detail::ScalarColumns::locate(pattern_->layout(), permutation[factor_->minor]);
      return {SolverStatus::Outcome::notPositiveDefinite, block, coordinate, std::numeric_limits<double>::quiet_NaN()};
    }
    factored_ = true;
    return {};
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    detail::validateSolve(name(), factored_, pattern_.get(), rightHandSides, count);
    if (rightHandSides.empty()) return {};
    cholmod_dense b{};
    b.nrow = b.d = factor_->n;
    b.ncol = static_cast<std::size_t>(count);
    b.nzmax = rightHandSides.size();
    b.x = rightHandSides.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    if (cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &solution_, nullptr, &work_, &workSparse_, &common_) == 0) {
      return {.outcome = SolverStatus::Outcome::memoryLimit};
    }
    const auto* x = static_cast<const double*>(solution_->x);
    std::copy(x, x + rightHandSides.size(), rightHandSides.begin());
    return {};
  }

  FactorStatistics statistics() const override { return statistics_; }

 private:
  void release() {
    factored_ = false;
    cholmod_free_factor(&factor_, &common_);
    cholmod_free_sparse(&matrix_, &common_);
    cholmod_free_dense(&solution_, &common_);
    cholmod_free_dense(&work_, &common_);
    cholmod_free_dense(&workSparse_, &common_);
  }

  std::shared_ptr<const BlockPattern> pattern_;
  detail::ScalarColumns columns_;
  cholmod_common common_{};
  cholmod_sparse* matrix_ = nullptr;
  cholmod_factor* factor_ = nullptr;
  cholmod_dense* solution_ = nullptr;
  cholmod_dense* work_ = nullptr;
  cholmod_dense* workSparse_ = nullptr;
  FactorStatistics statistics_;
  bool factored_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> makeCholmodSolver() { return std::make_unique<CholmodSolver>(); }

}  // namespace quiver
