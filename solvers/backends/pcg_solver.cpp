#include <quiver/solvers/backends/pcg_solver.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <quiver/core/util/parallel.h>
#include <quiver/solvers/backends/forcing_term.h>
#include <quiver/solvers/backends/validate.h>
#include <quiver/solvers/block/symmetric_product.h>

namespace quiver {
namespace {

/// Block rows of one task: fixed, so that sums are added in the same order for any number of threads.
constexpr int chunkBlocks = 512;
constexpr double loosest = 0.1;

/// Lower Cholesky factor of a column-major n × n block in place; the coordinate of the first pivot that is not
/// positive, or −1.
int factorBlock(double* a, int n, double& pivot) {
  for (int k = 0; k < n; ++k) {
    pivot = a[k * n + k];
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return k;
    const double root = std::sqrt(pivot);
    for (int i = k; i < n; ++i) a[k * n + i] /= root;
    for (int j = k + 1; j < n; ++j) {
      for (int i = j; i < n; ++i) a[j * n + i] -= a[k * n + i] * a[k * n + j];
    }
  }
  return -1;
}

class PcgSolver final : public LinearSolver {
 public:
  explicit PcgSolver(const PcgOptions& options) : options_(options), forcing_(loosest, options.tolerance) {}

  std::string name() const override { return "pcg"; }

  void analyze(std::shared_ptr<const BlockPattern> pattern, int threads) override {
    pattern_ = std::move(pattern);
    threads_ = threads;
    product_ = SymmetricProduct(*pattern_);
    const BlockLayout& layout = pattern_->layout();
    chunks_ = (layout.blocks() + chunkBlocks - 1) / chunkBlocks;
    const auto scalars = static_cast<std::size_t>(layout.scalars());
    for (std::vector<double>* vector : {&x_, &r_, &z_, &p_, &q_}) vector->assign(scalars, 0.0);
    damping_.reserve(scalars);
    factorBegin_.assign(1, 0);
    for (const int n : layout.dimensions()) factorBegin_.push_back(factorBegin_.back() + std::int64_t{n} * n);
    factors_.assign(static_cast<std::size_t>(factorBegin_.back()), 0.0);
    partial_.assign(static_cast<std::size_t>(chunks_), 0.0);
    statistics_ = {};
    for (const int n : layout.dimensions()) {
      statistics_.nonzeros += std::int64_t{n} * (n + 1) / 2;
      statistics_.flops += n * (n + 1.0) * (2.0 * n + 1.0) / 6.0;
    }
    statistics_.bytes = static_cast<std::int64_t>((6 * scalars + factors_.size()) * sizeof(double)) + product_.bytes();
    matrix_ = nullptr;
    forcing_.restart();
  }

  void restart() override { forcing_.restart(); }

  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop) override {
    detail::validateFactorize(name(), pattern_.get(), matrix, damping);
    matrix_ = nullptr;
    stop_ = stop;
    if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
    damping_.assign(damping.begin(), damping.end());
    const BlockLayout& layout = pattern_->layout();
    for (int block = 0; block < layout.blocks(); ++block) {
      const int n = layout.dimension(block);
      double* a = factors_.data() + factorBegin_[static_cast<std::size_t>(block)];
      std::copy_n(matrix.block(pattern_->columnBegin(block)), n * n, a);
      for (int i = 0; i < n && !damping_.empty(); ++i)
        a[i * (n + 1)] += damping_[static_cast<std::size_t>(layout.offset(block) + i)];
      double pivot = 0.0;
      const int coordinate = factorBlock(a, n, pivot);
      if (coordinate >= 0) return {SolverStatus::Outcome::notPositiveDefinite, block, coordinate, pivot};
    }
    matrix_ = &matrix;
    fresh_ = true;
    return {};
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    detail::validateSolve(name(), matrix_ != nullptr, pattern_.get(), rightHandSides, count);
    const auto scalars = static_cast<std::size_t>(pattern_->layout().scalars());
    statistics_.iterations = 0;
    for (int k = 0; k < count; ++k) {
      const SolverStatus status = iterate(rightHandSides.subspan(static_cast<std::size_t>(k) * scalars, scalars));
      if (!status.ok()) return status;
    }
    return {};
  }

  FactorStatistics statistics() const override { return statistics_; }

 private:
  /// Calls work(first scalar, last scalar, first block, last block) for every chunk and adds what it returns, in order.
  template <typename Work>
  double sumOverChunks(const Work& work) {
    const BlockLayout& layout = pattern_->layout();
    parallelFor(chunks_, threads_, [&](std::int64_t c) {
      const int begin = static_cast<int>(c) * chunkBlocks;
      const int end = std::min(layout.blocks(), begin + chunkBlocks);
      partial_[static_cast<std::size_t>(c)] = work(static_cast<std::size_t>(layout.offset(begin)),
                                                   static_cast<std::size_t>(layout.offset(end)), begin, end);
    });
    double sum = 0.0;
    for (const double value : partial_) sum += value;
    return sum;
  }

  /// z = M⁻¹ r over some blocks; returns their part of rᵀz.
  double precondition(int begin, int end) {
    const BlockLayout& layout = pattern_->layout();
    double sum = 0.0;
    for (int block = begin; block < end; ++block) {
      const int n = layout.dimension(block);
      const double* L = factors_.data() + factorBegin_[static_cast<std::size_t>(block)];
      double* z = z_.data() + layout.offset(block);
      std::copy_n(r_.data() + layout.offset(block), n, z);
      for (int j = 0; j < n; ++j) {
        z[j] /= L[j * n + j];
        sum += z[j] * z[j];  // rᵀM⁻¹r = ‖L⁻¹r‖²
        for (int i = j + 1; i < n; ++i) z[i] -= L[j * n + i] * z[j];
      }
      for (int j = n - 1; j >= 0; --j) {
        for (int i = j + 1; i < n; ++i) z[j] -= L[j * n + i] * z[i];
        z[j] /= L[j * n + j];
      }
    }
    return sum;
  }

  /// q = (H + D) p; returns pᵀq.
  double applyMatrix() {
    return sumOverChunks([&](std::size_t first, std::size_t last, int begin, int end) {
      product_.multiply(*matrix_, p_.data(), q_.data(), begin, end);
      double sum = 0.0;
      for (std::size_t i = first; i < last; ++i) {
        if (!damping_.empty()) q_[i] += damping_[i] * p_[i];
        sum += p_[i] * q_[i];
      }
      return sum;
    });
  }

  int mostIterations() const {
    if (options_.maxIterations > 0) return options_.maxIterations;
    return static_cast<int>(std::min<std::int64_t>(10000, 10 * pattern_->layout().scalars()));
  }

  SolverStatus iterate(std::span<double> b) {
    std::fill(x_.begin(), x_.end(), 0.0);
    double rz = sumOverChunks([&](std::size_t first, std::size_t last, int begin, int end) {
      for (std::size_t i = first; i < last; ++i) r_[i] = b[i];
      return precondition(begin, end);
    });
    // Beside the one step that each factorisation is for, solves are as exact as asked.
    const bool loose = options_.forcing && std::exchange(fresh_, false);
    const double goal = (loose ? forcing_.next(std::sqrt(rz)) : options_.tolerance) * std::sqrt(rz);
    p_ = z_;
    SolverStatus status;
    for (int iteration = 0; std::sqrt(rz) > goal; ++iteration) {
      if (stop_.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
      if (iteration >= mostIterations()) {
        status.outcome = SolverStatus::Outcome::notConverged;
        break;
      }
      const double curvature = applyMatrix();
      if (!(curvature > 0.0)) {
        status.outcome = SolverStatus::Outcome::notPositiveDefinite;
        status.pivot = curvature;
        break;
      }
      const double alpha = rz / curvature;
      const double next = sumOverChunks([&](std::size_t first, std::size_t last, int begin, int end) {
        for (std::size_t i = first; i < last; ++i) {
          x_[i] += alpha * p_[i];
          r_[i] -= alpha * q_[i];
        }
        return precondition(begin, end);
      });
      const double beta = next / rz;
      rz = next;
      sumOverChunks([&](std::size_t first, std::size_t last, int, int) {
        for (std::size_t i = first; i < last; ++i) p_[i] = z_[i] + beta * p_[i];
        return 0.0;
      });
      ++statistics_.iterations;
    }
    std::copy(x_.begin(), x_.end(), b.begin());
    return status;
  }

  PcgOptions options_;
  std::shared_ptr<const BlockPattern> pattern_;
  int threads_ = 1;
  int chunks_ = 0;
  SymmetricProduct product_;
  const BlockMatrix* matrix_ = nullptr;
  StopCondition stop_;
  std::vector<double> damping_;
  std::vector<std::int64_t> factorBegin_;
  std::vector<double> factors_;  // L of every diagonal block, column-major
  std::vector<double> x_, r_, z_, p_, q_;
  std::vector<double> partial_;
  ForcingTerm forcing_;
  bool fresh_ = false;
  FactorStatistics statistics_;
};

}  // namespace

std::unique_ptr<LinearSolver> makePcgSolver(const PcgOptions& options) { return std::make_unique<PcgSolver>(options); }

}  // namespace quiver
