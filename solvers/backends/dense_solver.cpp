#include <quiver/solvers/backends/dense_solver.h>

#include <algorithm>

#include <quiver/core/util/parallel.h>
#include <quiver/solvers/backends/scalar_columns.h>
#include <quiver/solvers/backends/validate.h>
#include <quiver/solvers/cholesky/kernels/kernel_level.h>
#include <quiver/solvers/cholesky/panel.h>
#include <quiver/solvers/cholesky/work_buffer.h>

namespace quiver {
namespace {

/// The matrix is one panel: all columns, no rows below.
class DenseSolver final : public LinearSolver {
 public:
  std::string name() const override { return "dense"; }

  void analyze(std::shared_ptr<const BlockPattern> pattern, int threads) override {
    pattern_ = std::move(pattern);
    threads_ = threads;
    size_ = pattern_->layout().scalars();
    rows_ = (size_ + 7) / 8 * 8;
    stride_ = (rows_ / 8 | 1) * 8;  // an odd multiple of 8: columns do not fall on the same cache sets
    detail::reserve(factor_, stride_ * size_ + 8);
    detail::reserve(inverse_, size_);
    detail::reserve(x_, rows_);
    factored_ = false;
  }

  SolverStatus factorize(const BlockMatrix& matrix, std::span<const double> damping,
                         const StopCondition& stop) override {
    detail::validateFactorize(name(), pattern_.get(), matrix, damping);
    factored_ = false;
    if (stop.reached()) return {.outcome = SolverStatus::Outcome::interrupted};
    load(matrix, damping);
    const detail::Panel panel{factor_.data(), stride_, static_cast<int>(size_), static_cast<int>(rows_),
                              inverse_.data()};
    detail::UpcomingMemory none{};
    const detail::PanelFailure failure =
        detail::factorPanel(kernels_, panel, size_ < smallestShared ? 1 : threads_, stop, none);
    if (failure.stopped) return {.outcome = SolverStatus::Outcome::interrupted};
    if (failure.column >= 0) {
      const auto [block, coordinate] = detail::ScalarColumns::locate(pattern_->layout(), failure.column);
      return {SolverStatus::Outcome::notPositiveDefinite, block, coordinate, failure.pivot};
    }
    factored_ = true;
    return {};
  }

  SolverStatus solve(std::span<double> rightHandSides, int count) override {
    detail::validateSolve(name(), factored_, pattern_.get(), rightHandSides, count);
    for (int k = 0; k < count; ++k) {
      double* b = rightHandSides.data() + k * size_;
      std::fill(std::copy(b, b + size_, x_.data()), x_.data() + rows_, 0.0);
      const int columns = static_cast<int>(size_);
      kernels_.forward(factor_.data(), stride_, columns, static_cast<int>(rows_), inverse_.data(), x_.data());
      kernels_.backward(factor_.data(), stride_, columns, static_cast<int>(rows_), inverse_.data(), x_.data());
      std::copy(x_.data(), x_.data() + size_, b);
    }
    return {};
  }

  FactorStatistics statistics() const override {
    const auto n = static_cast<double>(size_);
    return {size_ * (size_ + 1) / 2, n * (n + 1) * (2 * n + 1) / 6, (factor_.size() + inverse_.size() + x_.size()) * 8,
            0};
  }

 private:
  /// Below this order a second thread costs more than it brings.
  static constexpr std::int64_t smallestShared = 192;

  void load(const BlockMatrix& matrix, std::span<const double> damping) {
    const BlockLayout& layout = pattern_->layout();
    parallelFor(layout.blocks(), size_ < smallestShared ? 1 : threads_, [&](std::int64_t c) {
      const auto column = static_cast<int>(c);
      double* const first = factor_.data() + layout.offset(column) * stride_;
      const int columns = layout.dimension(column);
      const auto clear = [&](std::int64_t begin, std::int64_t end) {
        for (int i = 0; begin < end && i < columns; ++i)
          std::fill(first + i * stride_ + begin, first + i * stride_ + end, 0.0);
      };
      // Kernels begin at the first row of a chunk. Above that nothing is read.
      std::int64_t done = layout.offset(column) / detail::chunkColumns * detail::chunkColumns;
      for (std::int64_t k = pattern_->columnBegin(column); k < pattern_->columnEnd(column); ++k) {
        const int row = pattern_->row(k);
        const int rows = layout.dimension(row);
        clear(done, layout.offset(row));
        done = layout.offset(row) + rows;
        const double* from = matrix.block(k);
        double* to = first + layout.offset(row);
        // A call for each of so few numbers would cost more than moving them.
        for (int i = 0; i < columns; ++i, from += rows, to += stride_) {
          for (int r = 0; r < rows; ++r) to[r] = from[r];
        }
      }
      clear(done, rows_);
    });
    for (std::size_t i = 0; i < damping.size(); ++i)
      factor_[static_cast<std::int64_t>(i) * (stride_ + 1)] += damping[i];
  }

  const detail::KernelTable& kernels_ = detail::kernelTable(detail::KernelLevel::automatic);
  std::shared_ptr<const BlockPattern> pattern_;
  int threads_ = 1;
  std::int64_t size_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t stride_ = 8;
  AlignedBuffer factor_;
  AlignedBuffer inverse_;
  AlignedBuffer x_;
  bool factored_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> makeDenseSolver() { return std::make_unique<DenseSolver>(); }

}  // namespace quiver
